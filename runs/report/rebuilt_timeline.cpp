#include "runs/report/rebuilt_timeline.h"

#include <optional>
#include <sstream>
#include <string>

#include "core/json_file.h"
#include "core/text_file.h"
#include "runs/report/inside.h"

namespace hookeye {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// An object, empty where the step's file does not hold one.
json object_in(const fs::path& file) {
  std::string damage;
  const auto found =
      inside(file.parent_path(), file) ? parse_json(read_text(file), damage) : std::nullopt;
  return found && found->is_object() ? *found : json::object();
}

/// One line of parameters.csv; words stand in quotes and may hold commas.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields = {""};
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

json parameters_in(const fs::path& file) {
  json all = json::array();
  if (!inside(file.parent_path(), file)) return all;
  std::istringstream lines(read_text(file));
  std::string line;
  std::getline(lines, line);  // the head
  while (std::getline(lines, line)) {
    const auto fields = fields_of(line);
    if (fields.size() != 6) continue;
    json one = {{"name", fields[0]}, {"unit", fields[1]}, {"long_name", fields[2]}};
    const char* keys[] = {"value", "low", "high"};
    try {
      for (size_t i = 0; i < 3; ++i) one[keys[i]] = std::stod(fields[3 + i]);
    } catch (const std::exception&) {
      continue;  // cut short
    }
    all.push_back(std::move(one));
  }
  return all;
}

json rebuilt_step(const fs::path& folder, const json& metrics) {
  const std::string full = folder.filename().string();
  const std::string name = full.substr(std::min(full.find('-') + 1, full.size()));
  const bool adds = name != "base" && name.rfind("without-", 0) != 0;
  const json diagnosis = object_in(folder / "diagnosis.json");
  json out = {
      {"name", name},
      {"added", adds ? json(name) : json()},
      {"parameters", diagnosis.contains("parameters") ? diagnosis["parameters"]
                                                      : parameters_in(folder / "parameters.csv")},
      {"diagnosis", diagnosis.value("effects", json::array())}};
  for (const char* key : {"chi_fit", "rms_px_fit", "converged", "iterations", "undetermined"})
    if (metrics.contains(key)) out[key] = metrics[key];
  // Nothing held out: metrics.json has 0 there, the timeline null.
  for (const char* key : {"chi_validate", "rms_px_validate"})
    out[key] = metrics.value(key, json()) == json(0.0) ? json() : metrics.value(key, json());
  if (diagnosis.contains("gate")) out["gate"] = diagnosis["gate"];
  return out;
}

}  // namespace

json rebuilt_timeline(const std::vector<fs::path>& steps) {
  json out = {{"steps", json::array()}};
  for (const auto& folder : steps) {
    const json metrics = object_in(folder / "metrics.json");
    out["steps"].push_back(rebuilt_step(folder, metrics));
    if (metrics.contains("floor")) out["floor"] = metrics["floor"];
  }
  return out;
}

}  // namespace hookeye
