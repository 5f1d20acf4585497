#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

/// The forms, as variants begin: the lamp's direction turned about two axes normal to it, its
/// strength alone, both at once (of the refit), and the ambient level raised.
const char* const kSun = "sun ";
const char* const kStrength = "strength ";
const char* const kLamp = "lamp ";
const char* const kAmbient = "ambient ";

/// What follows one of them in a variant: "from twist on".
std::string when(const std::string& variant) { return variant.substr(variant.find(' ') + 1); }

/// Light that is other than told from some example on or in one.
class LightDirection final : public Effect {
 public:
  std::string name() const override { return "light_direction"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "the light changed"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "The lamp stands elsewhere than told, is stronger or weaker, or it was moved, or the "
           "room grew brighter, from some example on or in one alone. Refitted with direction and "
           "strength together, of which what is nothing is dropped. Easily taken for exposure; it "
           "follows the surface's normals, so that bending and twisting of the body are weakly "
           "like it.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    Ingredients all;
    const auto lit = sun_stretches(model);
    for (const auto& where : lit) all.push_back(lamp(kSun, where));
    auto shaded = [&](int e) {
      const auto& photos = model.examples[e].photos;
      return !photos.empty() && photos.front().shaded;
    };
    for (const auto& where : stretches(*model.scene, shaded)) all.push_back(raised_ambient(where));
    for (const auto& where : lit) all.push_back(lamp(kStrength, where));
    if (all.empty() && why_not) *why_not = "no photo is shaded by a light of the model";
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    for (const char* kind : {kSun, kStrength, kLamp})
      if (starts_with(variant, kind))
        for (const auto& where : sun_stretches(model))
          if (where.text == when(variant)) return lamp(kind, where);
    return nullptr;
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge == FormEdge::refit) return whole_lamp(model, from, values);
    return edge == FormEdge::plainer ? angles_or_strength(model, from, values)
                                     : std::vector<NextForm>{};
  }

  /// Without what is nearer to nothing, in units of what counts as large.
  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const std::string variant = ingredient.variant();
    const std::string then = examples_quoted(*model.scene, when(variant));
    if (starts_with(variant, kAmbient))
      return fmt::format("{} the ambient light is {} by {}", then,
                         values[0] >= 0 ? "higher" : "lower", figure(std::abs(values[0])));
    const std::string degrees =
        figure(values.head(std::min<Eigen::Index>(2, values.size())).norm() * 180.0 / EIGEN_PI);
    const double log_gain = values[values.size() - 1];
    const std::string gain = fmt::format("{} % {}", figure(100.0 * std::abs(std::expm1(log_gain))),
                                         log_gain >= 0 ? "stronger" : "weaker");
    if (starts_with(variant, kStrength))
      return fmt::format("{} the lamp is {} than told", then, gain);
    return fmt::format("{} the light comes from {} degrees beside the told direction{}", then,
                       degrees, starts_with(variant, kLamp) ? " and is " + gain : "");
  }

 private:
  std::vector<NextForm> whole_lamp(const Model& model, const Ingredient& scored,
                                   const VectorXd& values) const {
    const bool turned = starts_with(scored.variant(), kSun);
    if (!turned && !starts_with(scored.variant(), kStrength)) return {};
    auto form = rebuild(model, kLamp + when(scored.variant()));
    if (!form) return {};
    return {{std::move(form),
             turned ? Vector3d(values[0], values[1], 0.0) : Vector3d(0.0, 0.0, values[0])}};
  }

  std::vector<NextForm> angles_or_strength(const Model& model, const Ingredient& lamp,
                                           const VectorXd& values) const {
    if (!starts_with(lamp.variant(), kLamp)) return {};
    const auto parameters = lamp.parameters();
    const bool turned = values.head<2>().norm() / parameters[0].typical >=
                        std::abs(values[2]) / parameters[2].typical;
    auto form = rebuild(model, (turned ? kSun : kStrength) + when(lamp.variant()));
    if (!form) return {};
    return {{std::move(form), turned ? VectorXd(values.head<2>()) : VectorXd(values.tail<1>())}};
  }

  static std::vector<Stretch> sun_stretches(const Model& model) {
    return stretches(*model.scene, [&](int e) { return any_sun(model.examples[e]); });
  }

  std::shared_ptr<const Ingredient> lamp(const std::string& kind, const Stretch& where) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = kind + where.text;
    const std::string prefix = parameter_prefix(name(), "", where.text);
    const bool turns = kind != kStrength, grows = kind != kSun;
    for (int i = 1; turns && i <= 2; ++i)
      spec.parameters.push_back({fmt::format("{}angle{}", prefix, i), "rad",
                                 fmt::format("turn of the light {}, angle {}", where.text, i), 0.0,
                                 -3.0, 3.0, 0.05, false});
    if (grows)
      spec.parameters.push_back({prefix + "strength", "",
                                 "log of the factor on the lamp's strength " + where.text, 0.0,
                                 -3.0, 3.0, 0.05, false});
    spec.touches = {.photos = true};
    spec.apply = [first = where.first, end = where.end, turns, grows](const VectorXd& values,
                                                                      Model& m) {
      for (int e = first; e < end; ++e)
        for (auto& photo : m.examples[e].photos) {
          if (!shaded_by_sun(photo)) continue;
          // the same axes for all photos: the sun is that of the set-up
          const auto [a, b] = normal_axes(photo.sun);
          if (turns) photo.sun = rotation_of(values[0] * a + values[1] * b) * photo.sun;
          if (grows) photo.sun *= std::exp(values[values.size() - 1]);
        }
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> raised_ambient(const Stretch& where) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = kAmbient + where.text;
    spec.parameters = {{parameter_prefix(name(), "", where.text) + "ambient", "",
                        "ambient light added " + where.text, 0.0, -10.0, 10.0, 0.05, false}};
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
