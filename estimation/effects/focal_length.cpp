#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "estimation/effects/toolbox.h"
#include "estimation/model/camera_calibration.h"

namespace hookeye {

namespace {

/// fx, fy and skew of one camera, or of all, times exp(z): a focal length, of a fisheye too; the
/// scale where rays are parallel.
class FocalLength final : public Effect {
 public:
  std::string name() const override { return "focal_length"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "wrong focal length"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "A camera's focal length (its magnification, where it is orthographic) is not the told "
           "one. "
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
        all.push_back(zoom(scene, camera.name));
    if (all.size() > 1) all.push_back(zoom(scene, ""));
    if (all.empty() && why_not) *why_not = "no photo is fitted";
    return all;
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const std::string& of = ingredient.variant();
    const std::string percent = figure(100.0 * std::abs(std::expm1(values[0])));
    const bool more = values[0] >= 0;
    if (is_scale(model, of))
      return fmt::format("the magnification of {} is {} % {} than told",
                         of == "all cameras" ? of : "camera " + of, percent,
                         more ? "larger" : "smaller");
    return fmt::format("the focal length of {} is {} % {} than told",
                       of == "all cameras" ? of : "camera " + of, percent,
                       more ? "longer" : "shorter");
  }

 private:
  /// Whether the rays of the camera, or of all, are parallel.
  static bool is_scale(const Model& model, const std::string& variant) {
    const auto& cameras = model.scene->capture.cameras;
    return std::all_of(cameras.begin(), cameras.end(), [&](const Camera& camera) {
      return (variant != "all cameras" && variant != camera.name) || !camera.model->central();
    });
  }

  /// "": all cameras.
  std::shared_ptr<const Ingredient> zoom(const Scene& scene, const std::string& camera) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = camera.empty() ? "all cameras" : camera;
    spec.parameters = {{"focal_length." + (camera.empty() ? std::string("all") : camera), "",
                        "log of the factor on the focal length", 0.0, -2.0, 2.0, 0.01, false}};
    std::map<std::string, OffCalibration> all;
    for (const Camera& one : scene.capture.cameras) {
      if (!camera.empty() && one.name != camera) continue;
      const OffCalibration& off =
          all.emplace(one.name, off_calibration(scene, one.name)).first->second;
      spec.touches.photos |= off.moves(6, 1), spec.touches.cameras |= off.moves(6, 1);
      spec.touches.measured |= off.deviations.size() > 0;
    }
    spec.apply = [all](const VectorXd& values, Model& m) {
      for (const auto& [name, off] : all) {
        const VectorXd numbers = off.seen(values[0] * VectorXd::Unit(7, 6), m);
        if (numbers.isZero(0.0)) continue;
        for (auto& example : m.examples)
          for (auto& photo : example.photos)
            if (photo.camera.name == name)
              photo.camera =
                  photo.camera.moved(numbers.head<3>(), numbers.segment<3>(3)).zoomed(numbers[6]);
      }
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(focal_length, FocalLength)
