#include "estimation/model.h"

#include <stdexcept>

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

std::vector<Parameter> ModelForm::parameters() const {
  std::vector<Parameter> all;
  for (const auto& ingredient : ingredients)
    for (auto& parameter : ingredient->parameters()) all.push_back(std::move(parameter));
  return all;
}

int ModelForm::size() const {
  int n = 0;
  for (const auto& ingredient : ingredients) n += static_cast<int>(ingredient->parameters().size());
  return n;
}

VectorXd ModelForm::initial() const {
  const auto all = parameters();
  VectorXd p(all.size());
  for (size_t i = 0; i < all.size(); ++i) p[i] = all[i].value;
  return p;
}

Model ModelForm::realise(const VectorXd& p) const {
  if (p.size() != size()) throw std::logic_error("realise: wrong number of parameters");
  Model model = start;
  int offset = 0;
  for (const auto& ingredient : ingredients) {
    const int n = static_cast<int>(ingredient->parameters().size());
    ingredient->apply(p.segment(offset, n), model);
    offset += n;
  }
  return model;
}

}  // namespace hookeye
