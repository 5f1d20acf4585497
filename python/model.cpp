#include "python/model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "estimation/effects/catalogue.h"
#include "estimation/model/held.h"
#include "python/errors.h"
#include "runs/add_step.h"

namespace hookeye {

namespace {

/// Without the interpreter's lock: what asks an effect written in Python on several threads would
/// wait for it for ever.
template <class Body>
auto unlocked(const Body& body) {
  const pybind11::gil_scoped_release others;
  return body();
}

}  // namespace

PythonModel::PythonModel(std::shared_ptr<OpenedCapture> capture)
    : capture_(std::move(capture)), whole_(base_form(capture_->scene())) {
  values_ = whole_.initial();
}

PythonModel::PythonModel(std::shared_ptr<OpenedCapture> capture, const ModelForm& form,
                         const VectorXd& p)
    : capture_(std::move(capture)), whole_(form) {
  const ModelForm base = base_form(form.scene);
  std::map<std::string, double> known;
  const auto moving = form.parameters();
  for (size_t i = 0; i < moving.size(); ++i) known[moving[i].name] = p[static_cast<int>(i)];
  for (auto& ingredient : whole_.ingredients) {
    const auto held = held_in(ingredient->variant());
    if (!held) continue;
    for (const auto& [name, value] : *held) known[name] = value, fixed_.insert(name);
    for (const auto& own : base.ingredients)
      if (own->name() == ingredient->name()) ingredient = own;
  }
  values_ = whole_.initial();
  const auto all = whole_.parameters();
  for (size_t i = 0; i < all.size(); ++i) values_[static_cast<int>(i)] = known.at(all[i].name);
}

size_t PythonModel::index_of(const std::string& name) const {
  std::vector<std::string> known;
  for (const Parameter& one : whole_.parameters()) {
    if (one.name == name) return known.size();
    known.push_back(one.name);
  }
  const std::string near = nearest_name(name, known);
  bad_argument(fmt::format("the model has no parameter '{}'", name),
               near.empty() ? fmt::format("it has {}", fmt::join(known, ", "))
                            : fmt::format("did you mean '{}'?", near));
}

void PythonModel::set(const std::string& name, double value) {
  const size_t i = index_of(name);
  const Parameter one = whole_.parameters()[i];
  if (!(value >= one.low && value <= one.high) || !std::isfinite(value))
    bad_argument(fmt::format("{} = {} is out of range", name, value),
                 fmt::format("a number between {} and {}", one.low, one.high));
  values_[static_cast<int>(i)] = value;
}

void PythonModel::fix(const std::string& name) {
  index_of(name);
  for (const auto& ingredient : whole_.ingredients)
    for (const Parameter& one : ingredient->parameters()) {
      if (one.name != name) continue;
      if (!ingredient->variant().empty() || find_effect(ingredient->name()))
        bad_argument(
            fmt::format("{} belongs to {}, whose numbers move together", name, ingredient->name()),
            "fix numbers of the capture's own model");
    }
  fixed_.insert(name);
}

void PythonModel::free(const std::string& name) {
  index_of(name);
  fixed_.erase(name);
}

Ingredients PythonModel::candidates(const std::string& name) const {
  check_effect(name);
  std::string why_not;
  Ingredients standing;
  for (const auto& one : whole_.ingredients)
    if (one->name() == name) standing.push_back(one);
  auto all = unlocked([&, state = state()] {
    const Effect& effect = *find_effect(name);
    return standing.empty() ? effect.candidates(state.realise(), &why_not)
                            : effect.candidates_beside(state.realise(), standing, &why_not);
  });
  if (all.empty()) bad_argument(fmt::format("{} cannot be added: {}", name, why_not), "another");
  return all;
}

std::vector<std::string> PythonModel::variants(const std::string& effect) const {
  std::vector<std::string> out;
  for (const auto& one : candidates(effect)) out.push_back(one->variant());
  return out;
}

void PythonModel::add(const std::string& name, const std::string& variant) {
  check_effect(name);
  const Effect& effect = *find_effect(name);
  const auto there = ingredients();
  if (!effect.several() && std::find(there.begin(), there.end(), name) != there.end())
    bad_argument(fmt::format("the model has {} already", name), "set its parameters");
  Ingredients all = candidates(name);
  auto chosen = variant.empty() ? all.front() : unlocked([&, state = state()] {
    return effect.candidate(state.realise(), variant);
  });
  if (!chosen)
    bad_argument(fmt::format("{} has no variant '{}' in this capture", name, variant),
                 fmt::format("Model.variants(\"{}\") lists them", name));
  if (effect.remeshes(chosen->variant()))
    bad_argument(fmt::format("{} changes the mesh, and with it the whole model", name),
                 "fit, and add it to the run: Run.add()");
  const auto parameters = chosen->parameters();
  for (const Parameter& mine : parameters)
    for (const Parameter& one : whole_.parameters())
      if (one.name == mine.name)
        bad_argument(fmt::format("the model has '{}' already", mine.name),
                     "set it, or add another variant");
  const auto before = values_.size();
  values_.conservativeResize(before + static_cast<Eigen::Index>(parameters.size()));
  for (size_t i = 0; i < parameters.size(); ++i)
    values_[before + static_cast<Eigen::Index>(i)] = parameters[i].value;
  whole_.ingredients.push_back(std::move(chosen));
}

void PythonModel::remove(const std::string& effect) {
  check_effect(effect);
  auto& all = whole_.ingredients;
  const size_t before = all.size();
  for (size_t i = all.size(); i-- > 0;) {
    if (all[i]->name() != effect) continue;
    values_ = whole_.layout().without(values_, i);
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (all.size() == before)
    bad_argument(fmt::format("the model has no {}", effect), "Model.ingredients tells what it has");
}

std::vector<std::string> PythonModel::ingredients() const {
  std::vector<std::string> out;
  for (const auto& one : whole_.ingredients) out.push_back(one->name());
  return out;
}

ModelForm PythonModel::form() const {
  ModelForm out = whole_;
  int offset = 0;
  for (auto& ingredient : out.ingredients) {
    std::map<std::string, double> told;
    for (const Parameter& one : ingredient->parameters()) {
      if (fixed_.count(one.name)) told[one.name] = values_[offset];
      ++offset;
    }
    if (!told.empty()) ingredient = hold(ingredient, told);
  }
  return out;
}

VectorXd PythonModel::p() const {
  std::vector<double> out;
  const auto all = whole_.parameters();
  for (size_t i = 0; i < all.size(); ++i)
    if (!fixed_.count(all[i].name)) out.push_back(values_[static_cast<int>(i)]);
  return Eigen::Map<const VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

std::string PythonModel::text() const {
  return unlocked([state = state()] { return write_model(state.form, state.p, catalogue()); });
}

ModelState PythonModel::state() const { return {capture_, form(), p()}; }

Workspace& PythonModel::workspace() {
  if (!workspace_) workspace_ = std::make_unique<Workspace>(whole_.scene);
  return *workspace_;
}

}  // namespace hookeye
