#include <fmt/format.h>

#include "estimation/effects/toolbox.h"
#include "estimation/model/base_ingredients.h"

namespace hookeye {

namespace {

/// density g on every element, one vector g for all examples (the rest photos included), in the
/// world: turned into the body's frame by the placement.
class Gravity final : public Effect {
 public:
  std::string name() const override { return "gravity"; }
  EffectGroup group() const override { return EffectGroup::loads; }
  std::string title() const override { return "self-weight"; }
  std::string manual() const override {
    return "The body's own weight acts in every photo, at rest too, along one direction in the "
           "world. Easily taken for swelling, for a set-up that is placed wrongly or for a soft "
           "clamp; a tilted base splits them.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Capture& capture = model.scene->capture;
    if (capture.gravity) {
      if (why_not) *why_not = "gravity is told in the capture";
      return {};
    }
    const bool dense = capture.body.density > 0.0;
    const double size = body_size(*model.scene).size;
    Parameter g;
    g.unit = dense ? capture.units.acceleration()
                   : fmt::format("{}/{}^3", capture.units.force, capture.units.length);
    g.typical = dense ? capture.units.metre() : 0.01 * initial_shear_modulus(model.energy) / size;
    IngredientSpec spec;
    spec.name = name();
    for (char axis : std::string("xyz")) {
      g.name = fmt::format("gravity.{}", axis);
      g.long_name = fmt::format("{} along {}", dense ? "gravity" : "specific weight", axis);
      spec.parameters.push_back(g);
    }
    spec.touches = {.loading = true};
    spec.apply = [](const VectorXd& values, Model& m) {
      const Vector3d in_body = m.placement.linear().transpose() * values;
      const auto weight =
          self_weight(m.scene->body->mesh, density_or_one(m.scene->capture), in_body);
      for (auto& example : m.examples) example.loading.forces.push_back(weight);
      m.gravity += values;
    };
    return {make_ingredient(std::move(spec))};
  }

  std::string sentence(const Model& model, const Ingredient&,
                       const VectorXd& values) const override {
    const Capture& capture = model.scene->capture;
    const Vector3d g = values;
    const Vector3d towards = g.norm() > 0.0 ? Vector3d(g.normalized()) : Vector3d::Zero();
    if (capture.body.density > 0.0)
      return fmt::format("self-weight, {} m/s2 towards {}",
                         figure(g.norm() / capture.units.metre()), vector_text(towards));
    return fmt::format("self-weight, {} {}/{}^3 towards {}", figure(g.norm()), capture.units.force,
                       capture.units.length, vector_text(towards));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(gravity, Gravity)
