#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// The force sensor reads something at no load: an offset common to all examples.
class ForceZero final : public Effect {
 public:
  std::string name() const override { return "force_zero"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "force sensor not zeroed"; }
  std::string manual() const override {
    return "All measured forces are off by the same vector: the sensor was not tared, or carries "
           "the weight of the grip. Easily taken for gravity; it moves nothing in the photos.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Capture& capture = model.scene->capture;
    double sigma = 0.0, largest = 0.0;
    for (const auto& example : capture.examples) {
      if (example.validate) continue;
      for (const auto& load : example.loads)
        if (load.force) largest = std::max(largest, load.force->norm());
      for (const auto& measured : example.measured)
        if (measured.kind == MeasuredSpec::Kind::force_on) {
          sigma = std::max(sigma, measured.sigma.maxCoeff());
          largest = std::max(largest, measured.value.norm());
        }
    }
    if (sigma == 0.0) {
      if (why_not) *why_not = "no force is measured in a fitted example";
      return {};
    }
    // What matters to a user: 3 % of the largest force, or what the sensor resolves where that is
    // more.
    const double typical = std::max(sigma, 0.03 * largest);
    IngredientSpec spec;
    spec.name = name();
    for (char axis : std::string("xyz"))
      spec.parameters.push_back({fmt::format("force_zero.{}", axis), capture.units.force,
                                 fmt::format("offset of the measured forces along {}", axis), 0.0,
                                 -1e6 * sigma, 1e6 * sigma, typical, false});
    spec.touches = {.measured = true};
    spec.apply = [](const VectorXd& values, Model& m) {
      for (auto& example : m.examples) example.force_offset += values;
    };
    return {make_ingredient(std::move(spec))};
  }

  std::string sentence(const Model& model, const Ingredient&,
                       const VectorXd& values) const override {
    return fmt::format(
        "the force sensor reads {} {} at no load, along {}", figure(values.norm()),
        model.scene->capture.units.force,
        vector_text(values.norm() > 0 ? Vector3d(values.normalized()) : Vector3d(values)));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(force_zero, ForceZero)
