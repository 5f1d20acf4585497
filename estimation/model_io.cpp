// model.yaml: what a step of a run believes; usable as -m. The file holds every ingredient with its
// variant and values; the capture gives the rest.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "estimation/effect.h"
#include "estimation/model.h"
#include "capture_io/run.h"

namespace hookeye {

std::string write_model(const ModelForm& form, const VectorXd& p) {
  YAML::Emitter out;
  out.SetDoublePrecision(17);
  out << YAML::BeginMap << YAML::Key << "hookeye_model" << YAML::Value << 1;
  out << YAML::Key << "ingredients" << YAML::Value << YAML::BeginSeq;
  int offset = 0;
  for (const auto& ingredient : form.ingredients) {
    out << YAML::BeginMap << YAML::Key << "name" << YAML::Value << ingredient->name();
    if (!ingredient->variant().empty())
      out << YAML::Key << "variant" << YAML::Value << YAML::DoubleQuoted << ingredient->variant();
    out << YAML::Key << "values" << YAML::Value << YAML::BeginMap;
    for (const auto& parameter : ingredient->parameters()) {
      out << YAML::Key << parameter.name << YAML::Value << p[offset++];
      if (!parameter.unit.empty()) out << YAML::Comment(parameter.unit);
    }
    out << YAML::EndMap << YAML::EndMap;
  }
  out << YAML::EndSeq << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

namespace {

Place place_of(const std::filesystem::path& file, const YAML::Node& node) {
  return {file.string(), node.Mark().line + 1, node.Mark().column + 1};
}

/// Values of one ingredient by name; every parameter must be there and no other.
void read_values(const std::filesystem::path& file, const YAML::Node& node,
                 const Ingredient& ingredient, std::vector<double>& values) {
  const YAML::Node map = node["values"];
  const auto parameters = ingredient.parameters();
  for (const auto& parameter : parameters) {
    if (!map || !map.IsMap() || !map[parameter.name])
      throw InputError(place_of(file, node),
                       fmt::format("'{}' has no value for '{}'", ingredient.name(), parameter.name),
                       "write every parameter under 'values'");
    double value = 0.0;
    try {
      value = map[parameter.name].as<double>();
    } catch (const YAML::Exception&) {
      throw InputError(place_of(file, map[parameter.name]),
                       fmt::format("'{}' is not a number", parameter.name), "write a number");
    }
    if (!(value >= parameter.low && value <= parameter.high))
      throw InputError(place_of(file, map[parameter.name]),
                       fmt::format("{} = {} is out of range", parameter.name, value),
                       fmt::format("between {} and {}", parameter.low, parameter.high));
    values.push_back(value);
  }
  for (const auto& entry : map) {
    const auto name = entry.first.as<std::string>();
    std::vector<std::string> known;
    for (const auto& parameter : parameters) known.push_back(parameter.name);
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_name(name, known);
    throw InputError(place_of(file, entry.first), fmt::format("unknown parameter '{}'", name),
                     near.empty() ? fmt::format("one of: {}", fmt::join(known, ", "))
                                  : fmt::format("did you mean '{}'?", near));
  }
}

std::shared_ptr<const Ingredient> find_ingredient(const std::filesystem::path& file,
                                                  const YAML::Node& node, const ModelForm& base,
                                                  const Model& model) {
  const auto name = node["name"] ? node["name"].as<std::string>() : std::string();
  for (const auto& ingredient : base.ingredients)
    if (ingredient->name() == name) return ingredient;
  std::vector<std::string> known;
  for (const auto& ingredient : base.ingredients) known.push_back(ingredient->name());
  for (const Effect* effect : catalogue()) known.push_back(effect->name());
  if (const Effect* effect = find_effect(name)) {
    const auto variant = node["variant"] ? node["variant"].as<std::string>() : std::string();
    if (auto ingredient = effect->candidate(model, variant)) return ingredient;
    throw InputError(place_of(file, node),
                     fmt::format("'{}' has no variant '{}' in this capture", name, variant),
                     "take the variant from a model.yaml of the same capture");
  }
  const std::string near = nearest_name(name, known);
  throw InputError(place_of(file, node), fmt::format("unknown ingredient '{}'", name),
                   near.empty() ? "see the list of effects" : "did you mean '" + near + "'?");
}

}  // namespace

std::pair<ModelForm, VectorXd> read_model(const std::filesystem::path& file,
                                          std::shared_ptr<const Scene> scene) {
  YAML::Node root;
  try {
    root = YAML::Load(read_text(file));
  } catch (const YAML::Exception& error) {
    throw InputError({file.string(), error.mark.line + 1, error.mark.column + 1},
                     "not a yaml file: " + error.msg, "a model.yaml as a run's step holds it");
  }
  if (!root.IsMap() || !root["hookeye_model"] || !root["ingredients"] ||
      !root["ingredients"].IsSequence())
    throw InputError({file.string(), 1, 1}, "not a model",
                     "a model.yaml as a run's step holds it (hookeye_model: 1)");
  const ModelForm base = base_form(scene);
  ModelForm form = base;
  form.ingredients.clear();
  std::vector<double> values;
  for (const auto& node : root["ingredients"]) {
    // variants are chosen on the model so far, as they were when the effect was added
    const Model so_far = form.realise(Eigen::Map<const VectorXd>(values.data(), values.size()));
    auto ingredient = find_ingredient(file, node, base, so_far);
    read_values(file, node, *ingredient, values);
    form.ingredients.push_back(std::move(ingredient));
  }
  return {form, Eigen::Map<const VectorXd>(values.data(), values.size())};
}

}  // namespace hookeye
