#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

const char* const kGainOf = "log gain of ";
const char* const kEachPhoto = "each photo";
const char* const kWithHeldOut = "each photo, held-out ones too";

/// Gains exp(a) on photos.
class Exposure final : public Effect {
 public:
  std::string name() const override { return "exposure"; }
  EffectGroup group() const override { return EffectGroup::measurement; }
  std::string title() const override { return "exposure changed"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "Some photos are brighter or darker as a whole: exposure time, aperture, a flickering "
           "lamp. Easily taken for a light that turned; it moves no edge, so it is hardly ever "
           "taken for mechanics.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Scene& scene = *model.scene;
    const auto& examples = scene.capture.examples;
    if (scene.capture.body.texture == BodySpec::Texture::rest &&
        scene.limits->fit.brightness_cell > 0.0) {
      if (why_not)
        *why_not =
            "with a texture from photos the model's picture follows the brightness of each photo";
      return {};
    }
    Ingredients all =
        per_camera(scene, why_not, [&](const Camera& camera, const FirstExample& first) {
          return one_gain(
              camera.name + " " + first.text,
              [&](size_t e, const auto& photo) {
                return static_cast<int>(e) >= first.index && photo.camera == camera.name;
              },
              model);
        });
    if (scene.capture.cameras.size() > 1)  // a lamp that grew brighter
      for (const FirstExample& first : first_examples(
               scene, [&](int e) { return !examples[static_cast<size_t>(e)].photos.empty(); }))
        all.push_back(one_gain(
            "all cameras " + first.text,
            [&](size_t e, const auto&) { return static_cast<int>(e) >= first.index; }, model));
    for (size_t k = 0; k < examples.size(); ++k)
      if (!examples[k].validate && examples[k].photos.size() > 1)
        all.push_back(one_gain(
            "all cameras in " + examples[k].name, [&](size_t e, const auto&) { return e == k; },
            model));
    if (!all.empty()) all.push_back(every_photo(model, false));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    return variant == kWithHeldOut ? every_photo(model, true) : nullptr;
  }
  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge != FormEdge::refit || from.variant() != kEachPhoto) return {};
    auto form = every_photo(model, true);
    VectorXd start = VectorXd::Zero(static_cast<Eigen::Index>(form->parameters().size()));
    start.head(values.size()) = values;
    return {{std::move(form), std::move(start)}};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    if (values.size() != 1)
      return "each photo has its own exposure: " + farthest(ingredient.parameters(), values);
    return fmt::format("exposure of {} is {}", examples_quoted(*model.scene, ingredient.variant()),
                       change(values[0]));
  }

 private:
  using Slots = std::vector<std::pair<int, int>>;  ///< example, photo

  static std::string change(double log_gain) {
    return fmt::format("{} % {}", figure(100.0 * std::abs(std::expm1(log_gain))),
                       log_gain >= 0 ? "brighter" : "darker");
  }

  /// The three photos that are farthest off, and how far the others are.
  static std::string farthest(const std::vector<Parameter>& photos, const VectorXd& values) {
    constexpr size_t kNamed = 3;
    std::vector<Eigen::Index> order(photos.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return std::abs(values[a]) > std::abs(values[b]); });
    std::string text;
    for (size_t i = 0; i < order.size() && i < kNamed; ++i)
      text += fmt::format("{}{} is {}", i ? ", " : "",
                          photos[order[i]].long_name.substr(std::string(kGainOf).size()),
                          change(values[order[i]]));
    if (order.size() > kNamed)
      text += fmt::format(", the others by {} % at most",
                          figure(100.0 * std::expm1(std::abs(values[order[kNamed]]))));
    return text;
  }

  static Parameter gain(const std::string& label, const std::string& of) {
    return {"exposure." + label, "", kGainOf + of, 0.0, -3.0, 3.0, 0.05, false};
  }

  template <class Chosen>
  std::shared_ptr<const Ingredient> one_gain(const std::string& variant, Chosen chosen,
                                             const Model& model) const {
    const auto& examples = model.scene->capture.examples;
    Slots slots;
    for (size_t e = 0; e < examples.size(); ++e)
      for (size_t k = 0; k < examples[e].photos.size(); ++k)
        if (chosen(e, examples[e].photos[k]))
          slots.emplace_back(static_cast<int>(e), static_cast<int>(k));
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    spec.parameters = {gain(variant, variant)};
    spec.touches = {.photos = true};
    spec.apply = [slots](const VectorXd& values, Model& m) {
      for (const auto& [e, k] : slots) m.examples[e].photos[k].gain *= std::exp(values[0]);
    };
    return make_ingredient(std::move(spec));
  }

  /// One gain a photo. Of held-out examples the fitted photos say nothing: theirs come with the
  /// refit, where their own photos settle them (settle_held_out).
  std::shared_ptr<const Ingredient> every_photo(const Model& model, bool held_out) const {
    const auto& examples = model.scene->capture.examples;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = held_out ? kWithHeldOut : kEachPhoto;
    Slots slots;
    for (const bool validate : {false, true})
      for (size_t e = 0; e < examples.size() && (held_out || !validate); ++e)
        for (size_t k = 0; k < examples[e].photos.size() && examples[e].validate == validate; ++k) {
          const std::string camera = examples[e].photos[k].camera;
          spec.parameters.push_back(
              gain(examples[e].name + "." + camera,
                   fmt::format("the photo of '{}' by '{}'", examples[e].name, camera)));
          if (validate) spec.parameters.back().example = static_cast<int>(e);
          slots.emplace_back(static_cast<int>(e), static_cast<int>(k));
        }
    spec.touches = {.photos = true};
    spec.apply = [slots](const VectorXd& values, Model& m) {
      for (size_t i = 0; i < slots.size(); ++i)
        m.examples[slots[i].first].photos[slots[i].second].gain *= std::exp(values[i]);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(exposure, Exposure)
