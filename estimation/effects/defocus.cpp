#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// Gaussian blur of one camera's photos, by variance (at the null a blur radius has no slope).
class Defocus final : public Effect {
 public:
  std::string name() const override { return "defocus"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "out of focus"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "Photos of one camera are blurred, from some example on: focus, motion, dirt. It leaves "
           "a residual at every edge of the texture but moves none of them, so it is hardly "
           "taken for mechanics; sharper photos than the model's pixel filter show as its opposite "
           "and are not allowed.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    return per_camera(*model.scene, why_not, [&](const Camera& camera, const FirstExample& first) {
      return blurred(camera.name, first);
    });
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    return fmt::format("camera {}: blurred by {} px (standard deviation)",
                       examples_quoted(*model.scene, ingredient.variant()),
                       figure(std::sqrt(std::max(0.0, values[0]))));
  }

 private:
  std::shared_ptr<const Ingredient> blurred(const std::string& camera,
                                            const FirstExample& first) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = camera + " " + first.text;
    std::string own = parameter_prefix(name(), camera, first.text);
    own.pop_back();  // the dot: one number
    spec.parameters = {{own, "px^2", fmt::format("blur variance of '{}' {}", camera, first.text),
                        0.0, 0.0, 400.0, 0.5, false}};
    spec.touches = {.photos = true};
    const int k = first.index;
    spec.apply = [camera, k](const VectorXd& values, Model& m) {
      for (size_t e = k; e < m.examples.size(); ++e)
        for (auto& photo : m.examples[e].photos)
          if (photo.camera.name == camera) photo.blur_variance += values[0];
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(defocus, Defocus)
