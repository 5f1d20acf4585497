#include "estimation/model/model.h"

#include <stdexcept>
#include <tuple>

#include "estimation/model/additive_material.h"
#include "estimation/model/effect.h"
#include "estimation/model/held.h"

namespace hookeye {

EnergyModel Model::energy_of(int example) const {
  EnergyModel scaled = energy;
  const double factor = examples[example].stiffness;
  if (factor == 1.0) return scaled;
  for (auto& part : scaled.parts) {
    if (part.weight.size() == 0) part.weight = VectorXd::Ones(scene->body->mesh.size());
    part.weight *= factor;
  }
  return scaled;
}

bool Ingredient::mechanics_derivative(const Eigen::VectorXd&, const Model&, int, const Equilibrium&,
                                      int, MechanicsDerivative&) const {
  return false;
}

std::shared_ptr<const Ingredient> Ingredient::with_bounds(
    const std::vector<std::pair<double, double>>&) const {
  return nullptr;
}

void set_bounds(std::vector<Parameter>& parameters,
                const std::vector<std::pair<double, double>>& bounds) {
  for (size_t i = 0; i < parameters.size(); ++i)
    std::tie(parameters[i].low, parameters[i].high) = bounds.at(i);
}

std::vector<Parameter> ModelForm::parameters() const {
  std::vector<Parameter> all;
  for (const auto& ingredient : ingredients)
    for (auto& parameter : ingredient->parameters()) all.push_back(std::move(parameter));
  return all;
}

VectorXd ModelForm::initial() const {
  const auto all = parameters();
  VectorXd p(all.size());
  for (size_t i = 0; i < all.size(); ++i) p[i] = all[i].value;
  return p;
}

Model ModelForm::realise(const VectorXd& p) const {
  const ParameterLayout at = layout();
  if (p.size() != at.size()) throw std::logic_error("realise: wrong number of parameters");
  Model model = start;
  for (size_t i = 0; i < ingredients.size(); ++i) {
    const VectorXd values = at.of(p, i);
    ingredients[i]->apply(values, model);
    model.applied.emplace_back(ingredients[i], values);
  }
  return model;
}

namespace {

std::shared_ptr<const Ingredient> same_ingredient(const ModelForm& base, const ModelForm& so_far,
                                                  const VectorXd& p, const Ingredient& wanted,
                                                  const Catalogue& effects) {
  if (const auto held = held_in(wanted.variant()))
    for (const auto& ingredient : base.ingredients)
      if (ingredient->name() == wanted.name()) return hold(ingredient, *held);
  if (wanted.name() == "material" && !wanted.variant().empty())
    return additive_material_from(wanted.variant(), base.scene->capture.units);
  for (const auto& ingredient : base.ingredients)
    if (ingredient->name() == wanted.name()) return ingredient;
  const Effect* effect = effects.find(wanted.name());
  return effect ? effect->candidate(so_far.realise(p), wanted.variant()) : nullptr;
}

}  // namespace

std::pair<ModelForm, VectorXd> transfer(const Model& model, std::shared_ptr<const Scene> scene,
                                        const Catalogue& effects) {
  const ModelForm base = base_form(std::move(scene));
  ModelForm form = base;
  form.ingredients.clear();
  VectorXd p(0);
  for (const auto& [ingredient, values] : model.applied) {
    auto same = same_ingredient(base, form, p, *ingredient, effects);
    if (!same)
      throw std::runtime_error("no " + ingredient->name() + " [" + ingredient->variant() +
                               "] on another mesh");
    std::map<std::string, double> known;
    const auto before = ingredient->parameters(), declared = same->parameters();
    for (size_t i = 0; i < before.size(); ++i) known[before[i].name] = values[i];
    const Eigen::Index offset = p.size();
    p.conservativeResize(offset + static_cast<Eigen::Index>(declared.size()));
    for (size_t i = 0; i < declared.size(); ++i) {
      const auto found = known.find(declared[i].name);
      p[offset + static_cast<Eigen::Index>(i)] =
          found == known.end() ? declared[i].value : found->second;
    }
    form.ingredients.push_back(std::move(same));
  }
  return {form, p};
}

}  // namespace hookeye
