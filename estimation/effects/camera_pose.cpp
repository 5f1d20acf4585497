#include <fmt/format.h>

#include "estimation/effects/toolbox.h"
#include "estimation/model/camera_calibration.h"

namespace hookeye {

namespace {

/// One camera stands elsewhere than told, from some example on: x_in_camera' = exp([w]x) x + v.
class CameraPose final : public Effect {
 public:
  std::string name() const override { return "camera_pose"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "a camera that moved"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "One camera was knocked between two examples, or its pose was wrong from the start. "
           "Easily taken for a set-up placed elsewhere (with one camera it is the same), for a "
           "wrong focal length or, in slender bodies, for a bending load; a second camera tells.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    return per_camera(*model.scene, why_not, [&](const Camera& camera, const FirstExample& first) {
      return moved(model, camera, first);
    });
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const Vector3d w = values.head<3>(), v = values.tail<3>();
    return fmt::format("camera {} stands elsewhere, turned by {} degrees and moved by {} {}",
                       examples_quoted(*model.scene, ingredient.variant()),
                       figure(w.norm() * 180.0 / EIGEN_PI), figure(v.norm()),
                       model.scene->capture.units.length);
  }

 private:
  std::shared_ptr<const Ingredient> moved(const Model& model, const Camera& camera,
                                          const FirstExample& first) const {
    const double size = body_size(*model.scene).size;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = camera.name + " " + first.text;
    for (int i = 0; i < 6; ++i) {
      const bool turn = i < 3;
      spec.parameters.push_back(
          {fmt::format("{}{}{}", parameter_prefix(name(), camera.name, first.text),
                       turn ? "r" : "t", "xyz"[i % 3]),
           turn ? "rad" : model.scene->capture.units.length,
           fmt::format("{} of camera '{}' {} its {} axis, {}", turn ? "rotation" : "motion",
                       camera.name, turn ? "about" : "along", "xyz"[i % 3], first.text),
           0.0, turn ? -1.0 : -10.0 * size, turn ? 1.0 : 10.0 * size, turn ? 0.002 : 0.01 * size,
           false});
    }
    // A calibration tells nothing of a knock after the first photo.
    const OffCalibration off = first.text == "from the start"
                                   ? off_calibration(*model.scene, camera.name)
                                   : OffCalibration{};
    spec.touches = {.photos = off.moves(0, 6),
                    .measured = off.deviations.size() > 0,
                    .cameras = off.moves(0, 6)};
    const std::string camera_name = camera.name;
    const int k = first.index;
    spec.apply = [camera_name, k, off](const VectorXd& values, Model& m) {
      VectorXd numbers = VectorXd::Zero(7);
      numbers.head<6>() = values;
      numbers = off.seen(numbers, m);
      if (numbers.isZero(0.0)) return;
      for (size_t e = k; e < m.examples.size(); ++e)
        for (auto& photo : m.examples[e].photos)
          if (photo.camera.name == camera_name)
            photo.camera =
                photo.camera.moved(numbers.head<3>(), numbers.segment<3>(3)).zoomed(numbers[6]);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(camera_pose, CameraPose)
