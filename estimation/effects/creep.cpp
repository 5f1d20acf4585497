#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

const char* const kLogarithmic = "with the logarithm of the order";
const char* const kSteady = "steadily with the order";

/// Growth of the compliance over the order of the examples, 0 at the first and 1 at the last.
double growth(const std::string& variant, int example, int count) {
  if (count < 2) return 0.0;
  if (variant == kSteady) return static_cast<double>(example) / (count - 1);
  return std::log1p(static_cast<double>(example)) / std::log(static_cast<double>(count));
}

/// Stiffness of example e divided by 1 + c growth(e): compliance grows while the body stays
/// loaded (logarithmic creep), all strains alike.
class Creep final : public Effect {
 public:
  std::string name() const override { return "creep"; }
  EffectGroup group() const override { return EffectGroup::history; }
  std::string title() const override { return "creep"; }
  std::string manual() const override {
    return "The body gives way more and more over the order of the examples. Easily taken for "
           "softening from one example on or for stiffening, where larger loads came later; an "
           "early load repeated at the end tells.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    if (model.examples.size() < 3) {
      if (why_not) *why_not = "fewer than three examples";
      return {};
    }
    return {form(kLogarithmic), form(kSteady)};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const auto& examples = model.scene->capture.examples;
    return fmt::format(
        "the body creeps from '{}' on, the first example: in the last ('{}') it gives {} % more, "
        "growing {}",
        examples.front().name, examples.back().name, figure(100.0 * values[0]),
        ingredient.variant());
  }

 private:
  std::shared_ptr<const Ingredient> form(const std::string& variant) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    spec.parameters = {{"creep.c", "", "growth of the compliance from first to last example", 0.0,
                        0.0, 50.0, 0.1, false}};
    spec.touches = {.energy = true};
    spec.apply = [variant](const VectorXd& c, Model& m) {
      const int count = static_cast<int>(m.examples.size());
      for (int e = 0; e < count; ++e)
        m.examples[e].stiffness /= 1.0 + c[0] * growth(variant, e, count);
    };
    const auto forces = std::make_shared<ElementForces>(
        [](const Model& m, int example, const VectorXd& q) -> Eigen::MatrixXd {
          return residual(m.scene->body->mesh, m.energy_of(example), Loading{}, q);
        });
    spec.derivative = [variant, forces](const VectorXd& c, const Model& m, int example,
                                        const Equilibrium& equilibrium, int,
                                        MechanicsDerivative& out) {
      const double g = growth(variant, example, static_cast<int>(m.examples.size()));
      if (g != 0.0) out.dR_dt = -g / (1.0 + c[0] * g) * *forces->at(m, example, equilibrium.q);
      return true;
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(creep, Creep)
