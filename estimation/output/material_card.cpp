#include "estimation/output/material_card.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "estimation/fit/material_scale.h"
#include "estimation/output/uniaxial.h"

namespace hookeye {
namespace {

using nlohmann::json;
using Spread = EnergyNeighbourhood::Spread;

/// Small-strain moduli of an energy that is the same along all directions.
struct Moduli {
  double mu = 0.0, kappa = 0.0;
  double E() const { return 9.0 * kappa * mu / (3.0 * kappa + mu); }
};
double poisson(double kappa_over_mu) {
  return (3.0 * kappa_over_mu - 2.0) / (2.0 * (3.0 * kappa_over_mu + 1.0));
}

Moduli at_rest(const MeanEnergy& energy) {
  const Matrix9d D = energy.dP_dF(Matrix3d::Identity());
  return {D(3, 3), D(0, 0) - 4.0 / 3.0 * D(3, 3)};
}

/// Stiffness in Voigt's order xx yy zz yz xz xy.
Eigen::Matrix<double, 6, 6> voigt(const MeanEnergy& energy) {
  static constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  const Matrix9d D = energy.dP_dF(Matrix3d::Identity());
  Eigen::Matrix<double, 6, 6> C;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      C(i, j) = D(kPairs[i][0] + 3 * kPairs[i][1], kPairs[j][0] + 3 * kPairs[j][1]);
  return C;
}

bool isotropic_at_rest(const MeanEnergy& energy) {
  const Moduli m = at_rest(energy);
  Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Zero();
  C.topLeftCorner<3, 3>().setConstant(m.kappa - 2.0 / 3.0 * m.mu);
  for (int i = 0; i < 3; ++i) C(i, i) += 2.0 * m.mu, C(i + 3, i + 3) = m.mu;
  const Eigen::Matrix<double, 6, 6> real = voigt(energy);
  return (real - C).cwiseAbs().maxCoeff() <= 1e-6 * real.cwiseAbs().maxCoeff();
}

/// A value with what is known of it.
json row(const Parameter& named, double value, const Spread& spread) {
  json out = {
      {"name", named.name}, {"unit", named.unit}, {"long_name", named.long_name}, {"value", value}};
  out["known"] = !spread.fitted ? "given" : spread.open ? "open" : "fitted";
  if (!spread.fitted || spread.open) return out;
  // As those of the fit (fit.cpp): symmetric in the logarithm where the value is positive.
  const double below = spread.shift - spread.half + std::min(spread.reach, 0.0);
  const double above = spread.shift + spread.half + std::max(spread.reach, 0.0);
  const bool log = named.positive && value > 0.0;
  out["low"] = log ? value * std::exp(below / value) : value + below;
  out["high"] = log ? value * std::exp(above / value) : value + above;
  return out;
}

/// The law's own parameters.
json parameter_rows(const Scene& scene, const EnergyNeighbourhood& near, size_t material) {
  json out = json::array();
  const Units& units = scene.capture.units;
  const auto all = near.model().energy.parts.at(material).term->parameters(units);
  for (size_t k = 0; k < all.size(); ++k) {
    const VectorXd gradient = near.gradient([&](const EnergyModel& beside) {
      return beside.parts.at(material).term->parameters(units).at(k).value;
    });
    out.push_back(row(all[k], all[k].value, near.spread(gradient, all[k].value)));
  }
  return out;
}

/// Rows of what follows from the mean energy.
class Derived {
 public:
  Derived(const EnergyNeighbourhood& near, int of)
      : near_(near), energy_(near.model().energy, of), beside_(near.means(of)) {}
  const MeanEnergy& energy() const { return energy_; }

  template <class Value>  ///< double(const MeanEnergy&)
  json of(const Parameter& named, Value&& value) const {
    const VectorXd gradient = difference(beside_, near_.parameters(), value);
    const double at = value(energy_);
    return row(named, at, near_.spread(gradient, at));
  }

  /// Its interval follows from that of kappa / mu, so that it never passes one half.
  json poissons_ratio() const {
    Parameter ratio{"nu", "", "Poisson's ratio at small strain"};
    ratio.positive = true;
    json out = of(ratio, [](const MeanEnergy& one) {
      const Moduli m = at_rest(one);
      return m.kappa / m.mu;
    });
    for (const char* key : {"value", "low", "high"})
      if (out.contains(key)) out[key] = poisson(out[key]);
    return out;
  }

 private:
  const EnergyNeighbourhood& near_;
  MeanEnergy energy_;
  std::vector<BothSides<MeanEnergy>> beside_;
};

Parameter stiffness(const std::string& name, const std::string& unit, const std::string& words) {
  Parameter out{name, unit, words};
  out.positive = true;
  return out;
}

/// `own`: rows of the law's parameters, which are not told twice.
json small_strain_rows(const Derived& derived, const std::string& unit, const json& own) {
  json out = json::array();
  const auto named = [&](const json& one) {
    return std::any_of(own.begin(), own.end(), [&](const json& other) {
      return other.at("name") == one.at("name") &&
             std::abs(other.at("value").get<double>() - one.at("value").get<double>()) <=
                 1e-9 * std::abs(one.at("value").get<double>());
    });
  };
  if (!isotropic_at_rest(derived.energy())) {
    for (int i = 0; i < 3; ++i)
      out.push_back(
          derived.of(stiffness(fmt::format("E{}", "xyz"[i]), unit,
                               fmt::format("Young's modulus along {} at small strain", "xyz"[i])),
                     [i](const MeanEnergy& one) {
                       const Eigen::Matrix<double, 6, 6> compliance = voigt(one).inverse();
                       return 1.0 / compliance(i, i);
                     }));
    return out;
  }
  const json rows[] = {derived.of(stiffness("mu", unit, "shear modulus at small strain"),
                                  [](const MeanEnergy& one) { return at_rest(one).mu; }),
                       derived.of(stiffness("kappa", unit, "bulk modulus at small strain"),
                                  [](const MeanEnergy& one) { return at_rest(one).kappa; }),
                       derived.of(stiffness("E", unit, "Young's modulus at small strain"),
                                  [](const MeanEnergy& one) { return at_rest(one).E(); }),
                       derived.poissons_ratio()};
  for (const json& one : rows)
    if (!named(one)) out.push_back(one);
  return out;
}

/// Whether an ingredient left its mark on the energy elsewhere than in the materials' own laws.
bool beside_the_law(const Model& before, const Model& after, size_t materials) {
  const EnergyModel &a = before.energy, &b = after.energy;
  if (a.parts.size() != b.parts.size() || a.swelling.size() != b.swelling.size()) return true;
  if (a.swelling.size() && a.swelling != b.swelling) return true;
  for (size_t i = 0; i < std::min(materials, a.parts.size()); ++i)
    if (a.parts[i].weight.size() != b.parts[i].weight.size() ||
        (a.parts[i].weight.size() && a.parts[i].weight != b.parts[i].weight))
      return true;
  for (size_t e = 0; e < before.examples.size(); ++e)
    if (before.examples[e].stiffness != after.examples[e].stiffness) return true;
  return false;
}

/// Names of the effects that change the energy beside the law, at their fitted values.
json effects_beside(const Fitted& fitted) {
  json out = json::array();
  ModelForm form = fitted.form;
  form.ingredients.clear();
  const size_t materials = fitted.form.scene->capture.materials.size();
  for (const auto& ingredient : fitted.form.ingredients) {
    if (!ingredient->touches().energy || ingredient->name() == "material") {
      form.ingredients.push_back(ingredient);
      continue;
    }
    const Model before = form.realise(fitted.p.head(form.size()));
    form.ingredients.push_back(ingredient);
    if (beside_the_law(before, form.realise(fitted.p.head(form.size())), materials))
      out.push_back(ingredient->name());
  }
  return out;
}

}  // namespace

json material_card(const Scene& scene, const Fitted& fitted, const EnergyNeighbourhood& near) {
  const auto& specs = scene.capture.materials;
  if (near.model().energy.parts.size() < specs.size() || specs.empty()) return {};
  const bool blended = std::any_of(specs.begin(), specs.end(),
                                   [](const MaterialSpec& one) { return one.blend.has_value(); });
  const json beside = effects_beside(fitted);
  json cards = json::array();
  for (size_t i = 0; i < specs.size(); ++i) {
    json card = {{"region", specs[i].region},
                 {"law", near.model().energy.parts[i].term->name()},
                 {"parameters", parameter_rows(scene, near, i)}};
    // Blended laws fill the same place: what follows is that of the mean of the body.
    if (!blended || i == 0) {
      const int of = blended ? -1 : static_cast<int>(i);
      card["small_strain"] =
          small_strain_rows(Derived(near, of), scene.capture.units.stress(), card["parameters"]);
      if (!beside.empty())
        for (json& one : card["small_strain"])
          one["long_name"] = one["long_name"].get<std::string>() + ", mean over the body";
      card["curves"] = uniaxial_curves(scene, fitted, near, of);
    }
    cards.push_back(std::move(card));
  }
  return {{"cards", std::move(cards)},
          {"blended", blended},
          {"beside", beside},
          {"depends", what_fixes_the_scale(scene, fitted)},
          {"yaml", material_yaml(scene.capture, near.model().energy)}};
}

}  // namespace hookeye
