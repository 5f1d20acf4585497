#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// Stiffness times 1 - d from one example on: damage by an earlier large strain (Mullins 1948).
class Softening final : public Effect {
 public:
  std::string name() const override { return "softening"; }
  EffectGroup group() const override { return EffectGroup::history; }
  std::string title() const override { return "softening by use"; }
  std::string manual() const override {
    return "From one example on the body is softer throughout, as rubber is after its first large "
           "stretch. Easily taken for creep or for a wrong size of the later loads; an early load "
           "repeated at the end, and once between, tells.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const auto& examples = model.scene->capture.examples;
    Ingredients all;
    for (const auto& first :
         first_examples(*model.scene, [&](int e) { return !is_rest(examples[e]); }))
      if (first.index > 0) all.push_back(from(model, first));
    if (all.empty() && why_not) *why_not = "fewer than two loaded examples are fitted";
    return all;
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    return fmt::format("{} the body is {} % softer than before",
                       examples_quoted(*model.scene, ingredient.variant()),
                       figure(100.0 * values[0]));
  }

 private:
  std::shared_ptr<const Ingredient> from(const Model&, const FirstExample& first) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = first.text;
    spec.parameters = {{"softening.d", "", "share of the stiffness lost " + first.text, 0.0, 0.0,
                        0.95, 0.1, false}};
    spec.touches = {.energy = true};
    const int k = first.index;
    spec.apply = [k](const VectorXd& d, Model& m) {
      for (size_t e = k; e < m.examples.size(); ++e) m.examples[e].stiffness *= 1.0 - d[0];
    };
    spec.derivative = [k](const VectorXd& d, const Model& m, int example,
                          const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
      if (example >= k)
        out.dR_dt = -1.0 / (1.0 - d[0]) *
                    residual(m.scene->body->mesh, m.energy_of(example), Loading{}, equilibrium.q);
      return true;
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(softening, Softening)
