#include <fmt/format.h>

#include <Eigen/Geometry>

#include "estimation/effects/toolbox.h"
#include "estimation/model/base_ingredients.h"

namespace hookeye {

namespace {

/// The whole set-up (body, supports, loads) stands elsewhere in the world than told: cameras and
/// light see it moved, and gravity turns against it.
class PlacementEffect final : public Effect {
 public:
  std::string name() const override { return "placement"; }
  EffectGroup group() const override { return EffectGroup::loads; }
  std::string title() const override { return "set-up placed elsewhere"; }
  std::string manual() const override {
    return "Body, supports and loads together stand a little away from, or turned against, what "
           "the camera poses were told for. Easily taken for a moved camera (with one camera it "
           "is the same) or for gravity; the rest photos show it whole.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Capture& capture = model.scene->capture;
    if (capture.body.fit_placement || capture.cameras.empty()) {
      if (why_not)
        *why_not = capture.cameras.empty() ? "there is no camera" : "the placement is fitted";
      return {};
    }
    const BodySize body = body_size(*model.scene);
    const Vector3d centre = body.centre;
    IngredientSpec spec;
    spec.name = name();
    for (int i = 0; i < 6; ++i) {
      const bool turn = i < 3;
      spec.parameters.push_back(
          {fmt::format("placement.{}{}", turn ? "r" : "t", "xyz"[i % 3]),
           turn ? "rad" : capture.units.length,
           fmt::format("{} of the set-up {} {}", turn ? "rotation" : "translation",
                       turn ? "about" : "along", "xyz"[i % 3]),
           0.0, turn ? -3.2 : -10.0 * body.size, turn ? 3.2 : 10.0 * body.size,
           turn ? 0.01 : 0.01 * body.size, false});
    }
    spec.touches = {.loading = true, .photos = true, .measured = true, .cameras = true};
    spec.apply = [centre](const VectorXd& values, Model& m) {
      place(m, pose_about(centre, values.head<3>(), values.tail<3>()));
    };
    return {make_ingredient(std::move(spec))};
  }

  std::string sentence(const Model& model, const Ingredient&,
                       const VectorXd& values) const override {
    const Vector3d w = values.head<3>(), t = values.tail<3>();
    return fmt::format("the set-up is turned by {} degrees about {} and moved by {} {} along {}",
                       figure(w.norm() * 180.0 / EIGEN_PI),
                       vector_text(w.norm() > 0 ? Vector3d(w.normalized()) : w), figure(t.norm()),
                       model.scene->capture.units.length,
                       vector_text(t.norm() > 0 ? Vector3d(t.normalized()) : t));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(placement, PlacementEffect)
