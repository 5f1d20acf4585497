#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

std::shared_ptr<const EnergyTerm> higher_order(double c2, double c3) {
  return yeoh(0.0, c2, c3, 0.0);
}

/// W += c2 (I1bar - 3)^2 + c3 (I1bar - 3)^3 (Yeoh 1993); the initial modulus stays.
class StrainStiffening final : public Effect {
 public:
  std::string name() const override { return "strain_stiffening"; }
  EffectGroup group() const override { return EffectGroup::material; }
  std::string title() const override { return "strain stiffening"; }
  std::string manual() const override {
    return "The material grows stiffer (or softer) with strain than the base law says, while its "
           "initial modulus stays. Easily taken for a wrong size of the larger loads, or for a "
           "mesh too coarse to bend; two load levels of the same kind tell.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
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
    return {make_ingredient(std::move(spec))};
  }

  std::string sentence(const Model& model, const Ingredient&,
                       const VectorXd& values) const override {
    // Uniaxial stretch 1.5: I1bar - 3 = 1.5^2 + 2/1.5 - 3; modulus 2 dW/dI1bar against its start.
    const double mu = initial_shear_modulus(model.energy);
    const double i = 1.5 * 1.5 + 2.0 / 1.5 - 3.0;
    const double change = 2.0 * (2.0 * values[0] * i + 3.0 * values[1] * i * i) / mu;
    return fmt::format(
        "the material {} with strain: at 50 % stretch its modulus is {} % {} than "
        "at rest (c2 {} {}, c3 {})",
        change >= 0 ? "stiffens" : "softens", figure(100.0 * std::abs(change)),
        change >= 0 ? "higher" : "lower", figure(values[0]), model.scene->capture.units.stress(),
        figure(values[1]));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(strain_stiffening, StrainStiffening)
