// model.yaml: what a step of a run believes; usable as -m. The file holds every ingredient with its
// variant and values; the capture gives the rest.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "capture_io/yaml_section.h"
#include "capture_io/yaml_tree.h"
#include "core/input_error.h"
#include "core/text_file.h"
#include "estimation/model/additive_material.h"
#include "estimation/model/effect.h"
#include "estimation/model/held.h"
#include "estimation/model/model.h"

namespace hookeye {

namespace {

const std::vector<std::string> kIngredientKeys = {"name", "variant", "values", "bounds"};

/// Beyond every number that a bound may be: written for a side that has none.
constexpr double kNoBound = 1e300;

/// Bounds of an effect, which scale with the model that it was added to.
std::string bounds_text(const std::vector<Parameter>& parameters) {
  std::string out = parameters.empty() ? "" : "    bounds:\n";
  for (const auto& parameter : parameters)
    out += fmt::format("      {}: [{:.17g}, {:.17g}]\n", parameter.name,
                       std::max(parameter.low, -kNoBound), std::min(parameter.high, kNoBound));
  return out;
}

}  // namespace

std::string write_model(const ModelForm& form, const VectorXd& p, const Catalogue& effects) {
  std::string out = "hookeye_model: 1\ningredients:";
  out += form.ingredients.empty() ? " []\n" : "\n";
  int offset = 0;
  for (const auto& ingredient : form.ingredients) {
    out += fmt::format("  - name: {}\n", ingredient->name());
    // a JSON string is a yaml string
    if (!ingredient->variant().empty())
      out += fmt::format("    variant: {}\n", nlohmann::json(ingredient->variant()).dump());
    const auto parameters = ingredient->parameters();
    out += parameters.empty() ? "    values: {}\n" : "    values:\n";
    for (const auto& parameter : parameters)
      out += fmt::format("      {}: {:.17g}{}\n", parameter.name, p[offset++],
                         parameter.unit.empty() ? "" : "  # " + parameter.unit);
    if (effects.find(ingredient->name())) out += bounds_text(parameters);
  }
  return out;
}

namespace {

/// Values of one ingredient by name; every parameter must be there and no other.
void read_values(const YamlNode& node, const Ingredient& ingredient, std::vector<double>& values) {
  std::vector<std::string> known;
  for (const auto& parameter : ingredient.parameters()) known.push_back(parameter.name);
  const YamlSection map(node, fmt::format("values of {}", ingredient.name()), known);
  for (const auto& parameter : ingredient.parameters()) {
    const YamlNode& given = map.need(parameter.name, "write every parameter under `values`");
    const double value = read_number(given, parameter.name);
    if (!(value >= parameter.low && value <= parameter.high))
      throw InputError(given.place, fmt::format("{} = {} is out of range", parameter.name, value),
                       fmt::format("between {} and {}", parameter.low, parameter.high));
    values.push_back(value);
  }
}

/// The ingredient with the bounds that it was written with, where they stand.
std::shared_ptr<const Ingredient> with_written_bounds(
    const YamlSection& section, std::shared_ptr<const Ingredient> ingredient) {
  const YamlNode* written = section.find("bounds");
  if (!written) return ingredient;
  std::vector<std::string> known;
  for (const auto& parameter : ingredient->parameters()) known.push_back(parameter.name);
  const YamlSection map(*written, fmt::format("bounds of {}", ingredient->name()), known);
  const char* right = "[low, high] of every parameter, or no `bounds`";
  std::vector<std::pair<double, double>> bounds;
  for (const auto& name : known) {
    const YamlNode& node = map.need(name, right);
    const auto ends = read_numbers(node, name);
    if (ends.size() != 2 || !(ends[0] <= ends[1]))
      throw InputError(node.place, fmt::format("`{}` has no two rising bounds", name), right);
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    bounds.emplace_back(ends[0] <= -kNoBound ? -kInfinite : ends[0],
                        ends[1] >= kNoBound ? kInfinite : ends[1]);
  }
  auto out = ingredient->with_bounds(bounds);
  if (!out)
    throw InputError(written->place, fmt::format("`{}` has bounds of its own", ingredient->name()),
                     "leave `bounds` out");
  return out;
}

/// The base ingredient with the numbers that its variant holds. Null: it holds none.
std::shared_ptr<const Ingredient> held_ingredient(const YamlNode& variant, const std::string& name,
                                                  const ModelForm& base) {
  const auto told = held_in(read_string(variant, "variant"));
  if (!told) return nullptr;
  try {
    for (const auto& ingredient : base.ingredients)
      if (ingredient->name() == name) return hold(ingredient, *told);
  } catch (const std::invalid_argument& error) {
    throw InputError(variant.place, error.what(), "take it from a model.yaml of the same capture");
  }
  return nullptr;
}

/// A run's own model.yaml has no slip of the pen: what the catalogue lacks was registered from
/// Python when it was written.
[[noreturn]] void unknown_ingredient(const YamlNode& named, const std::string& name,
                                     const std::vector<std::string>& known) {
  const std::string near = nearest_name(name, known);
  throw InputError(
      named.place, fmt::format("there is no effect `{}` here", name),
      fmt::format("{}one written in Python is registered before the run is opened: "
                  "`hookeye.register(...)` of the class of this name (docs/python.md); the command "
                  "line has those of `hookeye effects` alone",
                  near.empty() ? "" : fmt::format("did you mean `{}`? Else ", near)));
}

std::shared_ptr<const Ingredient> find_ingredient(const YamlSection& section, const ModelForm& base,
                                                  const Model& model, const Catalogue& effects) {
  const YamlNode& named = section.need("name", "name: material, or an effect's name");
  const std::string name = read_string(named, "name");
  std::vector<std::string> known;
  const YamlNode* structure = section.find("variant");
  if (structure)
    if (auto held = held_ingredient(*structure, name, base)) return held;
  if (name == "material" && structure) {
    try {
      auto material =
          additive_material_from(read_string(*structure, "variant"), base.scene->capture.units);
      if (!fits_capture(*material, base.scene->capture))
        throw std::invalid_argument("the capture has no such material");
      return material;
    } catch (const std::invalid_argument& error) {
      throw InputError(structure->place,
                       fmt::format("the material's variant is damaged: {}", error.what()),
                       "take it from a model.yaml of a run");
    }
  }
  for (const auto& ingredient : base.ingredients) {
    if (ingredient->name() == name) return ingredient;
    known.push_back(ingredient->name());
  }
  if (const Effect* effect = effects.find(name)) {
    const YamlNode* given = section.find("variant");
    const std::string variant = given ? read_string(*given, "variant") : std::string();
    if (auto ingredient = effect->candidate(model, variant)) return ingredient;
    throw InputError(given ? given->place : named.place,
                     fmt::format("`{}` has no variant `{}` in this capture", name, variant),
                     "take the variant from a model.yaml of the same capture");
  }
  for (const Effect* effect : effects) known.push_back(effect->name());
  unknown_ingredient(named, name, known);
}

}  // namespace

namespace {

/// The scene on whose mesh the ingredients live: an effect may have asked for a finer one.
std::shared_ptr<const Scene> scene_of(const std::vector<YamlNode>& ingredients,
                                      std::shared_ptr<const Scene> told, const Catalogue& effects) {
  for (const YamlNode& node : ingredients) {
    const YamlSection section(node, "an ingredient", kIngredientKeys);
    const YamlNode* name = section.find("name");
    const YamlNode* variant = section.find("variant");
    const Effect* effect = name ? effects.find(read_string(*name, "name")) : nullptr;
    if (!effect || !variant) continue;
    const std::string wanted = read_string(*variant, "variant");
    if (effect->remeshes(wanted)) return effect->refit_scene(*told, wanted);
  }
  return told;
}

}  // namespace

std::pair<ModelForm, VectorXd> read_model(const std::filesystem::path& file,
                                          std::shared_ptr<const Scene> scene,
                                          const Catalogue& effects) {
  const YamlNode root = parse_yaml(read_text(file), file.string());
  const YamlSection top(root, "a model", {"hookeye_model", "ingredients"});
  const char* right = "a model.yaml as a run's step holds it (hookeye_model: 1)";
  const YamlNode& version = top.need("hookeye_model", right);
  if (read_integer(version, "hookeye_model") != 1)
    throw InputError(version.place, "a model of another version", right);
  const auto& ingredients = read_list(top.need("ingredients", right), "ingredients", right);
  const ModelForm base = base_form(scene_of(ingredients, std::move(scene), effects));
  ModelForm form = base;
  form.ingredients.clear();
  std::vector<double> values;
  for (const YamlNode& node : ingredients) {
    const YamlSection section(node, "an ingredient", kIngredientKeys);
    // variants are chosen on the model so far, as they were when the effect was added
    const Model so_far = form.realise(Eigen::Map<const VectorXd>(values.data(), values.size()));
    auto ingredient = with_written_bounds(section, find_ingredient(section, base, so_far, effects));
    read_values(section.need("values", "the ingredient's parameters"), *ingredient, values);
    form.ingredients.push_back(std::move(ingredient));
    const VectorXd so_far_values = Eigen::Map<const VectorXd>(values.data(), values.size());
    for (const AdditivePart& part : additive_parts(form, so_far_values))
      if (const auto wrong = fault(part.model))
        throw InputError(node.place, wrong->wrong, wrong->right);
    for (const ConvexPart& part : convex_parts(form, so_far_values))
      if (const auto wrong = convexity_fault(part.model))
        throw InputError(node.place, wrong->wrong, wrong->right);
  }
  return {form, Eigen::Map<const VectorXd>(values.data(), values.size())};
}

}  // namespace hookeye
