#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// fx and fy of one camera, or of all, times exp(z).
class FocalLength final : public Effect {
 public:
  std::string name() const override { return "focal_length"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "wrong focal length"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "A camera's focal length (its scale, where it is orthographic) is not the told one. "
           "For a body that is flat along the optical axis this is the same as a camera wrong in "
           "distance from the start; it is easily taken for swelling.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Scene& scene = *model.scene;
    Ingredients all;
    for (const auto& camera : scene.capture.cameras)
      if (!first_examples(scene, [&](int e) {
             return has_photo_of(scene, e, camera.name);
           }).empty())
        all.push_back(zoom(camera.name));
    if (all.size() > 1) all.push_back(zoom(""));
    if (all.empty() && why_not) *why_not = "no photo is fitted";
    return all;
  }

  std::string sentence(const Model&, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    return fmt::format(
        "the focal length of {} is {} % {} than told",
        ingredient.variant() == "all cameras" ? "all cameras" : "camera " + ingredient.variant(),
        figure(100.0 * std::abs(std::expm1(values[0]))), values[0] >= 0 ? "longer" : "shorter");
  }

 private:
  /// "": all cameras.
  std::shared_ptr<const Ingredient> zoom(const std::string& camera) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = camera.empty() ? "all cameras" : camera;
    spec.parameters = {{"focal_length." + (camera.empty() ? std::string("all") : camera), "",
                        "log of the factor on the focal length", 0.0, -2.0, 2.0, 0.01, false}};
    spec.touches = {.photos = true, .cameras = true};
    spec.apply = [camera](const VectorXd& values, Model& m) {
      for (auto& example : m.examples)
        for (auto& photo : example.photos)
          if (camera.empty() || photo.camera.name == camera)
            photo.camera = photo.camera.zoomed(values[0]);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(focal_length, FocalLength)
