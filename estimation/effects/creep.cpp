#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

const char* const kLogarithmic = "with the logarithm of the order";
const char* const kSteady = "steadily with the order";
// Retarded compliance, as of a body under loads that stay, and relaxing stiffness, as Prony series
// tell it: both with one time, counted in examples.
const char* const kRetarded = "free levelling off of the compliance";
const char* const kRelaxing = "free levelling off of the stiffness";

/// 1 - exp(-e / tau) over its value at the last example, and its derivative by tau.
Eigen::Vector2d levelling(double tau, int example, int count) {
  const auto at = [&](int e) {
    const double left = std::exp(-e / tau);
    return Eigen::Vector2d(-std::expm1(-e / tau), -left * e / (tau * tau));
  };
  const Eigen::Vector2d here = at(example), last = at(count - 1);
  const double g = here[0] / last[0];
  return {g, (here[1] - g * last[1]) / last[0]};
}

/// Growth of the compliance over the order of the examples, 0 at the first and 1 at the last.
double growth(const std::string& variant, int example, int count) {
  if (count < 2) return 0.0;
  if (variant == kSteady) return static_cast<double>(example) / (count - 1);
  return std::log1p(static_cast<double>(example)) / std::log(static_cast<double>(count));
}

/// Stiffness of an example with one time, its logarithm's derivatives by c and tau. At the last
/// example it is 1 / (1 + c) for either form.
struct Levelled {
  double stiffness = 1.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  Levelled(bool relaxing, const VectorXd& v, int example, int count) {
    if (count < 2 || example == 0) return;
    const Eigen::Vector2d g = levelling(v[1], example, count);
    const double c = v[0], lost = c / (1.0 + c);
    stiffness = relaxing ? 1.0 - lost * g[0] : 1.0 / (1.0 + c * g[0]);
    if (relaxing)
      slope = Eigen::Vector2d(g[0] / ((1.0 + c) * (1.0 + c)), lost * g[1]) / -stiffness;
    else
      slope = Eigen::Vector2d(g[0], c * g[1]) * -stiffness;
  }
};

/// Stiffness of example e divided by 1 + c growth(e): compliance grows while the body stays
/// loaded (logarithmic creep), all strains alike. The refit may go on to one that levels off.
class Creep final : public Effect {
 public:
  std::string name() const override { return "creep"; }
  EffectGroup group() const override { return EffectGroup::history; }
  std::string title() const override { return "creep"; }
  std::string manual() const override {
    return "The body gives way more and more over the order of the examples. Easily taken for "
           "softening from one example on or for stiffening, where larger loads came later; an "
           "early load repeated at the end, and once between, tells. Time is the order of the "
           "examples, not a clock: where they are far from evenly spaced in time its size says "
           "little. The refit goes on to creep that levels off after "
           "some examples where neither the logarithm nor a steady growth is enough.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    if (model.examples.size() < 3) {
      if (why_not) *why_not = "fewer than three examples";
      return {};
    }
    return {form(kLogarithmic), form(kSteady)};
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    if (variant != kRetarded && variant != kRelaxing) return nullptr;
    return levelling_form(model, variant);
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge != FormEdge::further || values.size() != 1) return {};
    const double last = static_cast<double>(model.examples.size()) - 1.0;
    // Nearly a line over twice all examples; half of it after a third of them as the logarithm's.
    const double tau = from.variant() == kSteady ? 2.0 * last : 0.4 * last;
    return {{levelling_form(model, kRetarded), Eigen::Vector2d(values[0], tau)},
            {levelling_form(model, kRelaxing), Eigen::Vector2d(values[0], tau)}};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const auto& examples = model.scene->capture.examples;
    const std::string how = values.size() == 2
                                ? fmt::format("levelling off after {} examples", figure(values[1]))
                                : "growing " + ingredient.variant();
    return fmt::format(
        "the body creeps from '{}' on, the first example: in the last ('{}') it gives {} % more, "
        "{}",
        examples.front().name, examples.back().name, figure(100.0 * values[0]), how);
  }

 private:
  static Parameter growth_of_compliance() {
    return {"creep.c", "",   "growth of the compliance from first to last example", 0.0, 0.0, 50.0,
            0.1,       false};
  }

  static std::shared_ptr<ElementForces> internal_forces() {
    return std::make_shared<ElementForces>(
        [](const Model& m, int example, const VectorXd& q) -> Eigen::MatrixXd {
          return residual(m.scene->body->mesh, m.energy_of(example), Loading{}, q);
        });
  }

  std::shared_ptr<const Ingredient> levelling_form(const Model& model,
                                                   const std::string& variant) const {
    const double last = std::max(1.0, static_cast<double>(model.examples.size()) - 1.0);
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    // After a tenth of an example nothing is left to see; over ten times all of them it is a line.
    spec.parameters = {growth_of_compliance(),
                       {"creep.tau", "", "examples after which it has levelled off to 37 %",
                        0.4 * last, 0.1, 10.0 * last, 0.2 * last, true}};
    spec.touches = {.energy = true};
    const bool relaxing = variant == kRelaxing;
    spec.apply = [relaxing](const VectorXd& v, Model& m) {
      const int count = static_cast<int>(m.examples.size());
      for (int e = 0; e < count; ++e)
        m.examples[e].stiffness *= Levelled(relaxing, v, e, count).stiffness;
    };
    spec.derivative = [relaxing, forces = internal_forces()](
                          const VectorXd& v, const Model& m, int example,
                          const Equilibrium& equilibrium, int k, MechanicsDerivative& out) {
      const Levelled here(relaxing, v, example, static_cast<int>(m.examples.size()));
      if (here.slope[k] != 0.0) out.dR_dt = here.slope[k] * *forces->at(m, example, equilibrium.q);
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> form(const std::string& variant) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    spec.parameters = {growth_of_compliance()};
    spec.touches = {.energy = true};
    spec.apply = [variant](const VectorXd& c, Model& m) {
      const int count = static_cast<int>(m.examples.size());
      for (int e = 0; e < count; ++e)
        m.examples[e].stiffness /= 1.0 + c[0] * growth(variant, e, count);
    };
    const auto forces = internal_forces();
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
