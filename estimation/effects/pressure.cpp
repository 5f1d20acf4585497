#include <fmt/format.h>

#include <set>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

const char* const kWholeSurface = "on the whole surface";

/// A pressure that follows the deformed surface, the same in all examples.
class Pressure final : public Effect {
 public:
  std::string name() const override { return "pressure"; }
  EffectGroup group() const override { return EffectGroup::loads; }
  std::string title() const override { return "pressure"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "A pressure acts on a part of the surface in every example, at rest too: a fluid, a "
           "vacuum, a membrane. Easily taken for swelling (a pressure all around shrinks a "
           "compressible body) or for gravity.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    const Scene& scene = *model.scene;
    std::set<std::string> supports;
    for (const auto& example : scene.capture.examples)
      for (const auto& support : example.supports) supports.insert(support.region);
    Ingredients all;
    for (const auto& [region, patch] : scene.body->regions.all())
      if (!supports.count(region) && patch.area > 0.0)
        all.push_back(on(model, "on " + region, region, patch));
    all.push_back(on(model, kWholeSurface, "surface", whole_boundary(scene.body->mesh)));
    return all;
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    return fmt::format("a {} of {} {} {}", values[0] >= 0 ? "pressure" : "suction",
                       figure(std::abs(values[0])), model.scene->capture.units.stress(),
                       ingredient.variant());
  }

 private:
  std::shared_ptr<const Ingredient> on(const Model& model, const std::string& variant,
                                       const std::string& label, const Region& patch) const {
    const double mu = initial_shear_modulus(model.energy);
    const auto region = std::make_shared<const Region>(patch);
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    spec.parameters = {{"pressure." + label, model.scene->capture.units.stress(),
                        "pressure " + variant, 0.0, -10.0 * mu, 10.0 * mu, 0.05 * mu, false}};
    spec.touches = {.loading = true};
    spec.apply = [region](const VectorXd& values, Model& m) {
      const auto force = follower_pressure(*region, values[0]);
      for (auto& example : m.examples) example.loading.forces.push_back(force);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(pressure, Pressure)
