#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

std::shared_ptr<const EnergyTerm> higher_order(double c2, double c3) {
  return yeoh(0.0, c2, c3, 0.0);
}

/// Ogden's term (1972) with unit modulus, less neo-Hooke's: nothing is added at rest.
std::shared_ptr<const EnergyTerm> power_of_stretch(double k, double alpha) {
  return combination({{k, ogden({2.0 / alpha}, {alpha}, 0.0)}, {-k, neo_hookean(1.0, 0.0)}});
}

/// As scored; what a rubber with a second term stiffens by has 4 .. 12.
const double kPower = 8.0;

/// Amounts of shear over which the modulus of an additive material is tried to change: from what
/// photos just show to a rubber's, each twice the last.
const double kStiffeningReaches[] = {0.05, 0.1, 0.2, 0.4, 0.8};

/// A function of I1bar whose modulus is zero at rest and `values` at the control points after it.
AdditiveModel stiffening(const AdditiveModel& base, std::vector<double> at,
                         const VectorXd& values) {
  VectorXd from_rest(values.size() + 1);
  from_rest << 0.0, values;
  at.insert(at.begin(), 0.0);
  AdditiveModel out = in_frame_of(base);
  add_addend(out, "I1bar", at, {}, from_rest);
  return out;
}

/// W += c2 (I1bar - 3)^2 + c3 (I1bar - 3)^3 (Yeoh 1993), the same in tension and compression of
/// equal I1bar, or a power of the principal stretches, which stiffens more in tension; of an
/// additive material a function of I1bar whose modulus rises or falls up to one control point, then
/// two. The initial modulus stays.
class StrainStiffening final : public Effect {
 public:
  std::string name() const override { return "strain_stiffening"; }
  EffectGroup group() const override { return EffectGroup::material; }
  std::string title() const override { return "strain stiffening"; }
  std::string manual() const override {
    return "The material grows stiffer (or softer) with strain than the base law says, while its "
           "initial modulus stays. Easily taken for a wrong size of the larger loads, or for a "
           "mesh too coarse to bend; two load levels of the same kind tell. It stiffens with I1 "
           "(Yeoh) "
           "or with a power of the stretches (Ogden), which pulls more than it pushes.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    if (!additive_base(model)) return {of_law(model), of_power(model, false)};
    Ingredients all;
    for (double reach : kStiffeningReaches) all.push_back(of_additive(model, {reach}));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    if (variant == kFreePower && !additive_base(model)) return of_power(model, true);
    if (!starts_with(variant, kAdditive) || !additive_base(model)) return nullptr;
    const auto at = ramp_in(variant);
    if (at.empty()) return nullptr;
    return of_additive(model, at);
  }

  /// The same function with a control point in the middle; the power free.
  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge != FormEdge::refit) return {};
    if (from.variant() == kScoredPower)
      return {{of_power(model, true), Eigen::Vector2d(values[0], kPower)}};
    if (!starts_with(from.variant(), kAdditive)) return {};
    VectorXd finer = values;
    const auto at = refined_ramp(ramp_in(from.variant()), finer);
    return {{of_additive(model, at), std::move(finer)}};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const double mu = initial_shear_modulus(model.energy);
    if (starts_with(ingredient.variant(), kAdditive)) {
      // the inner control point: the outer one may lie beyond what any photo shows
      const double change = values[0] / mu;
      return fmt::format(
          "the material {} with strain: at an amount of shear of {} its modulus is {}",
          change >= 0 ? "stiffens" : "softens", figure(ramp_in(ingredient.variant()).front()),
          against_rest(change));
    }
    const std::string stress = model.scene->capture.units.stress();
    if (ingredient.variant() == kScoredPower || ingredient.variant() == kFreePower) {
      // Uniaxial stretch 1.5: the stress of the power against neo-Hooke's of the same modulus.
      const double alpha = values.size() == 2 ? values[1] : kPower;
      const double stress_ratio = 2.0 / alpha * (std::pow(1.5, alpha) - std::pow(1.5, -alpha / 2)) /
                                  (1.5 * 1.5 - 1.0 / 1.5);
      return fmt::format(
          "the material stiffens with strain, in tension more than in compression: at 50 % stretch "
          "its modulus is {} ({} {} goes with the power {} of the stretches)",
          against_rest(values[0] / mu * (stress_ratio - 1.0)), figure(values[0]), stress,
          figure(alpha));
    }
    // Uniaxial stretch 1.5: I1bar - 3 = 1.5^2 + 2/1.5 - 3; modulus 2 dW/dI1bar against its start.
    const double i = 1.5 * 1.5 + 2.0 / 1.5 - 3.0;
    const double change = 2.0 * (2.0 * values[0] * i + 3.0 * values[1] * i * i) / mu;
    return fmt::format(
        "the material {} with strain: at 50 % stretch its modulus is {} (c2 {} {}, c3 {})",
        change >= 0 ? "stiffens" : "softens", against_rest(change), figure(values[0]), stress,
        figure(values[1]));
  }

 private:
  static constexpr const char* kAdditive = "additive at";
  static constexpr const char* kScoredPower = "power 8 of the stretches";
  static constexpr const char* kFreePower = "free power of the stretches";

  /// A modulus that is 1 + change times that at rest, in words.
  static std::string against_rest(double change) {
    if (change <= -1.0) return "nothing (the curve is told beyond what was seen)";
    if (change > 1.0) return fmt::format("{} times that at rest", figure(1.0 + change));
    return fmt::format("{} % {} than at rest", figure(100.0 * std::abs(change)),
                       change >= 0 ? "higher" : "lower");
  }

  std::shared_ptr<const Ingredient> of_additive(const Model& model,
                                                const std::vector<double>& at) const {
    const double mu = initial_shear_modulus(model.energy);
    FunctionSpec spec;
    spec.name = name();
    spec.variant = kAdditive;
    for (size_t i = 0; i < at.size(); ++i) {
      spec.variant += fmt::format(" {:g}", at[i]);
      spec.parameters.push_back({fmt::format("strain_stiffening.k{}", i + 1),
                                 model.scene->capture.units.stress(),
                                 fmt::format("shear modulus added at I1bar = {:g}", at[i]), 0.0,
                                 -mu, std::numeric_limits<double>::infinity(), 0.5 * mu, false});
    }
    spec.functions = [base = in_frame_of(*additive_base(model)), at](const VectorXd& values) {
      return stiffening(base, at, values);
    };
    return additive_function(std::move(spec));
  }

  std::shared_ptr<const Ingredient> of_power(const Model& model, bool free) const {
    const double mu = initial_shear_modulus(model.energy);
    IngredientSpec spec;
    spec.name = name();
    spec.variant = free ? kFreePower : kScoredPower;
    spec.parameters = {{"strain_stiffening.k", model.scene->capture.units.stress(),
                        "modulus that goes with the power", 0.0, 0.0, 1e3 * mu, mu, false}};
    // at the power of two, neo-Hooke's, the modulus would mean nothing
    if (free)
      spec.parameters.push_back({"strain_stiffening.alpha", "", "power of the principal stretches",
                                 kPower, 3.0, 50.0, 4.0, false});
    spec.touches = {.energy = true};
    spec.apply = [](const VectorXd& v, Model& m) {
      if (v[0] != 0.0) add_part(m.energy, power_of_stretch(v[0], v.size() == 2 ? v[1] : kPower));
    };
    spec.derivative = [](const VectorXd& v, const Model& m, int example,
                         const Equilibrium& equilibrium, int k, MechanicsDerivative& out) {
      if (k != 0) return false;
      out.dR_dt = part_force(m, example, equilibrium.q,
                             power_of_stretch(1.0, v.size() == 2 ? v[1] : kPower));
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> of_law(const Model& model) const {
    const double mu = initial_shear_modulus(model.energy);
    const std::string stress = model.scene->capture.units.stress();
    const double infinite = std::numeric_limits<double>::infinity();
    IngredientSpec spec;
    spec.name = name();
    spec.parameters = {{"strain_stiffening.c2", stress, "modulus of (I1bar - 3)^2", 0.0, -mu,
                        infinite, 0.5 * mu, false},
                       {"strain_stiffening.c3", stress, "modulus of (I1bar - 3)^3", 0.0, -mu,
                        infinite, 0.5 * mu, false}};
    spec.touches = {.energy = true};
    spec.apply = [](const VectorXd& values, Model& m) {
      add_part(m.energy, higher_order(values[0], values[1]));
    };
    spec.derivative = [](const VectorXd& values, const Model& m, int example,
                         const Equilibrium& equilibrium, int k, MechanicsDerivative& out) {
      if (!values.isZero(0.0)) return false;
      out.dR_dt = part_force(m, example, equilibrium.q, higher_order(k == 0, k == 1));
      return true;
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(strain_stiffening, StrainStiffening)
