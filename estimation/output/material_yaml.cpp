// The line of a capture that gives the fitted material again.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "estimation/output/material_card.h"
#include "simulation/additive.h"

namespace hookeye {
namespace {

using Entries = std::vector<std::pair<std::string, std::string>>;

/// Digits enough to copy; of an additive material, which may stand at the edge of convexity, all.
constexpr int kDigits = 6, kAllDigits = 17;

std::string number(double value, int digits = kDigits) {
  return fmt::format("{:.{}g}", value, digits);
}

std::string list(const std::vector<double>& values, int digits = kDigits) {
  std::vector<std::string> all;
  for (const double value : values) all.push_back(number(value, digits));
  return fmt::format("[{}]", fmt::join(all, ", "));
}

/// Rows of three, as frames and directions are written.
std::string rows_of_three(const std::vector<double>& values) {
  std::vector<std::string> rows;
  for (size_t i = 0; i + 3 <= values.size(); i += 3)
    rows.push_back(list({values[i], values[i + 1], values[i + 2]}, kAllDigits));
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

std::vector<double> numbers(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

std::string map(const Entries& entries) {
  std::vector<std::string> all;
  for (const auto& [key, value] : entries) all.push_back(key + ": " + value);
  return fmt::format("{{{}}}", fmt::join(all, ", "));
}

/// A key of yaml as it is, or quoted (a JSON string is a yaml string).
std::string key_text(const std::string& name) {
  const bool plain = !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) &&
                     std::all_of(name.begin(), name.end(),
                                 [](unsigned char c) { return std::isalnum(c) || c == '_'; });
  return plain ? name : nlohmann::json(name).dump();
}

/// Where a law's parameter stands in the capture: a key, and a place in its list.
struct Slot {
  std::string key;
  size_t index = 0;
};

/// Of "mu": mu; of "angle2": the second of angles; what has no name of its own (fung's g12) goes on
/// in the list before it.
Slot slot_of(const std::string& name, const MaterialSpec& spec, const Slot& before) {
  if (spec.parameters.count(name)) return {name, 0};
  std::string stem = name;
  while (!stem.empty() && std::isdigit(static_cast<unsigned char>(stem.back()))) stem.pop_back();
  for (const std::string& key : {stem, stem + "s"})
    if (spec.parameters.count(key) && stem != name)
      return {key, before.key == key ? before.index + 1 : 0};
  const auto going_on = spec.parameters.find(before.key);
  if (going_on != spec.parameters.end() && before.index + 1 < going_on->second.numbers.size())
    return {before.key, before.index + 1};
  return {name, 0};
}

/// Of a law that is written by its parameters.
Entries law_entries(const MaterialSpec& spec, const EnergyTerm& term, const Units& units) {
  auto values = spec.parameters;
  std::vector<std::string> order;
  Slot slot;
  for (const Parameter& parameter : term.parameters(units)) {
    slot = slot_of(parameter.name, spec, slot);
    auto& own = values[slot.key].numbers;
    if (own.size() <= slot.index) own.resize(slot.index + 1);
    own[slot.index] = parameter.value;
    if (std::find(order.begin(), order.end(), slot.key) == order.end()) order.push_back(slot.key);
  }
  // The ratio is no parameter of the law, but an effect may have moved it.
  if (values.count("kappa_over_mu")) {
    const Matrix9d D = term.dP_dF(Matrix3d::Identity());
    values["kappa_over_mu"].numbers = {D(0, 0) / D(3, 3) - 4.0 / 3.0};
  }
  for (const auto& [key, value] : values)
    if (std::find(order.begin(), order.end(), key) == order.end()) order.push_back(key);
  Entries out = {{"law", spec.law}}, frame;
  for (const std::string& key : order) {
    const auto& own = values.at(key).numbers;
    if (key.starts_with("frame."))
      frame.emplace_back(key.substr(6), list(own));
    else if (key == "frame" || key == "directions")
      out.emplace_back(key, rows_of_three(own));
    else
      out.emplace_back(key, own.size() == 1 && key != "angles" ? number(own[0]) : list(own));
  }
  if (!frame.empty()) out.emplace_back("frame", map(frame));
  return out;
}

/// Where a component's direction is told, once.
void tell_direction(const AdditiveModel& model, int component, std::vector<std::string>& told,
                    Entries& entries) {
  const StrainComponent& one = model.components[static_cast<size_t>(component)];
  if (one.kind != StrainComponent::Kind::fibre ||
      std::find(told.begin(), told.end(), one.name) != told.end())
    return;
  told.push_back(one.name);
  entries.emplace_back("direction", list(numbers(one.direction), kAllDigits));
}

Entries additive_entries(const AdditiveModel& model) {
  Entries out = {{"law", "additive"}};
  if (model.cylinder) {
    out.emplace_back("frame", map({{"axis", list(numbers(model.cylinder->axis))},
                                   {"center", list(numbers(model.cylinder->center))}}));
  } else if (!model.frame.isIdentity(0.0)) {
    const Matrix3d rows = model.frame;  // columns, one after the other: an axis a row
    out.emplace_back("frame", rows_of_three({rows.data(), rows.data() + 9}));
  }
  std::vector<std::string> told;
  std::vector<std::pair<std::string, Entries>> addends;
  const auto entries_of = [&](const std::string& name) -> Entries& {
    for (auto& [known, entries] : addends)
      if (known == name) return entries;
    return addends.emplace_back(name, Entries()).second;
  };
  for (const Addend& a : model.addends) {
    const std::string name = a.name.substr(0, a.name.find('.'));
    Entries& entries = entries_of(name);
    if (a.second < 0) tell_direction(model, a.first, told, entries);
    if (a.fixed) {
      // from nothing at its begin to its modulus
      const bool pulled = a.at.back() > 0.0;
      const double begin = pulled ? a.at.front() : a.at.back();
      entries.emplace_back(
          "wall", list({begin, a.at.back() - a.at.front(), a.stiffness.maxCoeff()}, kAllDigits));
      continue;
    }
    entries.emplace_back("at", list(a.at, kAllDigits));
    if (a.second >= 0) entries.emplace_back("at_2", list(a.at_second, kAllDigits));
    entries.emplace_back("stiffness", list(numbers(a.stiffness), kAllDigits));
  }
  for (const auto& [name, entries] : addends) out.emplace_back(key_text(name), map(entries));
  if (model.barrier_modulus > 0.0)
    out.emplace_back("barrier", map({{"modulus", number(model.barrier_modulus)},
                                     {"below", number(model.barrier_below)}}));
  return out;
}

}  // namespace

std::string material_yaml(const Capture& capture, const EnergyModel& energy) {
  Entries all;
  for (size_t i = 0; i < capture.materials.size(); ++i) {
    const MaterialSpec& spec = capture.materials[i];
    const EnergyTerm& term = *energy.parts.at(i).term;
    const AdditiveModel* additive = additive_model(term);
    Entries entries =
        additive ? additive_entries(*additive) : law_entries(spec, term, capture.units);
    if (spec.blend)
      entries.emplace_back("blend", map({{"along", list(numbers(spec.blend->along))},
                                         {"at", list(spec.blend->at)},
                                         {"weight", list(spec.blend->weight)}}));
    if (spec.region.empty()) return "material: " + map(entries);
    all.emplace_back(key_text(spec.region), map(entries));
  }
  return "material: " + map(all);
}

}  // namespace hookeye
