#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// Blinn-Phong highlight: strength |sun| max(0, n.h)^shininess.
class Specular final : public Effect {
 public:
  std::string name() const override { return "specular"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "glossy surface"; }
  std::string manual() const override {
    return "The surface reflects the lamp: highlights that do not belong to the texture and "
           "wander as the body deforms. Easily taken for exposure or for a light that turned; "
           "powder or crossed polarisers cure it.";
  }

  /// Scored at the shininess at which the model's derivative by the strength is taken (that of the
  /// photo's state); others can be built by their variant and compared by refit.
  Ingredients candidates(const Model& model, std::string* why_not) const override {
    for (const auto& example : model.examples)
      for (const auto& photo : example.photos)
        if (photo.shaded && !photo.sun.isZero(0.0)) return {gloss(photo.shininess)};
    if (why_not) *why_not = "no photo is shaded by a directed light of the model";
    return {};
  }

  std::shared_ptr<const Ingredient> rebuild(const Model&,
                                            const std::string& variant) const override {
    const auto n = numbers_in(variant);
    if (!starts_with(variant, "shininess") || n.size() != 1 || n[0] <= 0.0) return nullptr;
    return gloss(n[0]);
  }

  std::string sentence(const Model&, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    return fmt::format("the surface is glossy: highlight of strength {} ({})", figure(values[0]),
                       ingredient.variant());
  }

 private:
  std::shared_ptr<const Ingredient> gloss(double shininess) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = fmt::format("shininess {:g}", shininess);
    spec.parameters = {
        {"specular.strength", "", "strength of the highlight", 0.0, 0.0, 10.0, 0.1, false}};
    spec.touches = {.photos = true};
    spec.apply = [shininess](const VectorXd& values, Model& m) {
      for (auto& example : m.examples)
        for (auto& photo : example.photos) {
          if (!photo.shaded) continue;
          photo.specular += values[0];
          photo.shininess = shininess;
        }
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(specular, Specular)
