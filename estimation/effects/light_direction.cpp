#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

bool shaded_by_sun(const PhotoState& photo) { return photo.shaded && !photo.sun.isZero(0.0); }

bool any_sun(const ExampleModel& example) {
  for (const auto& photo : example.photos)
    if (shaded_by_sun(photo)) return true;
  return false;
}

/// Examples first, first + 1, ... end - 1.
struct Stretch {
  int first, end;
  std::string text;  ///< "from twist on", "in twist"
};

/// A lamp that was moved stays there, one that was hidden or joined by another for one example does
/// not.
std::vector<Stretch> stretches(const Scene& scene, const std::function<bool(int)>& concerned) {
  const auto& examples = scene.capture.examples;
  const int count = static_cast<int>(examples.size());
  std::vector<Stretch> out;
  for (const auto& first : first_examples(scene, concerned))
    out.push_back({first.index, count, first.text});
  for (int e = 0; e + 1 < count; ++e)
    if (!examples[e].validate && concerned(e)) out.push_back({e, e + 1, "in " + examples[e].name});
  return out;
}

/// The sun's direction turned about two axes normal to it, or the ambient level raised, from some
/// example on or in one.
class LightDirection final : public Effect {
 public:
  std::string name() const override { return "light_direction"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "the light changed"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "The lamp stands elsewhere than told, or it was moved, or the room grew brighter, from "
           "some example on or in one alone. Easily taken for exposure; it follows the surface's "
           "normals, so that "
           "bending and twisting of the body are weakly like it.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Scene& scene = *model.scene;
    Ingredients all;
    for (const auto& where : stretches(scene, [&](int e) { return any_sun(model.examples[e]); }))
      all.push_back(turned_sun(where));
    auto shaded = [&](int e) {
      const auto& photos = model.examples[e].photos;
      return !photos.empty() && photos.front().shaded;
    };
    for (const auto& where : stretches(scene, shaded)) all.push_back(raised_ambient(where));
    if (all.empty() && why_not) *why_not = "no photo is shaded by a light of the model";
    return all;
  }

  std::string sentence(const Model&, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    if (values.size() == 1)
      return fmt::format("{} the ambient light is {} by {}", ingredient.variant().substr(8),
                         values[0] >= 0 ? "higher" : "lower", figure(std::abs(values[0])));
    return fmt::format("{} the light comes from {} degrees beside the told direction",
                       ingredient.variant().substr(4), figure(values.norm() * 180.0 / EIGEN_PI));
  }

 private:
  std::shared_ptr<const Ingredient> turned_sun(const Stretch& where) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = "sun " + where.text;
    for (int i : {1, 2})
      spec.parameters.push_back({fmt::format("light_direction.angle{}", i), "rad",
                                 fmt::format("turn of the light {}, angle {}", where.text, i), 0.0,
                                 -3.0, 3.0, 0.05, false});
    spec.touches = {.photos = true};
    spec.apply = [first = where.first, end = where.end](const VectorXd& values, Model& m) {
      for (int e = first; e < end; ++e)
        for (auto& photo : m.examples[e].photos) {
          if (!shaded_by_sun(photo)) continue;
          // the same axes for all photos: the sun is that of the set-up
          const auto [a, b] = normal_axes(photo.sun);
          photo.sun = rotation_of(values[0] * a + values[1] * b) * photo.sun;
        }
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> raised_ambient(const Stretch& where) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = "ambient " + where.text;
    spec.parameters = {{"light_direction.ambient", "", "ambient light added " + where.text, 0.0,
                        -10.0, 10.0, 0.05, false}};
    spec.touches = {.photos = true};
    spec.apply = [first = where.first, end = where.end](const VectorXd& values, Model& m) {
      for (int e = first; e < end; ++e)
        for (auto& photo : m.examples[e].photos)
          if (photo.shaded) photo.ambient += values[0];
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(light_direction, LightDirection)
