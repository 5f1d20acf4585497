#include "batch/finding.h"

#include <fstream>

#include "capture_io/run.h"
#include "core/input_error.h"
#include "core/json_file.h"
#include "core/text_file.h"
#include "runs/report/answer.h"

namespace hookeye {
namespace {

using nlohmann::json;

json value_in(const json& object, const char* key) {
  return object.is_object() && object.contains(key) ? object[key] : json();
}

json texts_in(const json& object, const char* key) {
  json out = json::array();
  for (const json& one : value_in(object, key))
    if (one.is_string()) out.push_back(one);
  return out;
}

/// Name, unit, words, value and interval of each.
json parameters_of(const json& step) {
  json out = json::array();
  for (const json& one : value_in(step, "parameters"))
    if (one.is_object() && value_in(one, "name").is_string())
      out.push_back({{"name", one["name"]},
                     {"unit", value_in(one, "unit")},
                     {"long_name", value_in(one, "long_name")},
                     {"value", value_in(one, "value")},
                     {"low", value_in(one, "low")},
                     {"high", value_in(one, "high")}});
  return out;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

json finding_of_run(const std::filesystem::path& folder) {
  const Run run = Run::open(folder, false);
  const json& timeline = run.timeline();
  const json answer = answer_of(run.folder(), timeline);
  const json steps = timeline.value("steps", json::array());
  const json last = steps.empty() ? json() : steps.back();
  return {{"verdict", answer.at("headline")},
          {"sentence", answer.at("sentence")},
          {"found", texts_in(timeline, "missing")},
          {"tie", texts_in(timeline, "tie")},
          {"parameters", parameters_of(last)},
          {"chi_fit", value_in(last, "chi_fit")},
          {"chi_validate", value_in(last, "chi_validate")},
          {"rms_px", value_in(last, "rms_px_fit")},
          {"floor", value_in(value_in(timeline, "floor"), "chi")}};
}

json finding_of_log(const std::filesystem::path& log) {
  const std::string mark = "warning: ";
  std::ifstream lines(log);
  std::string first;
  int count = 0;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(mark) && ++count == 1) first = line.substr(mark.size());
  const std::string verdict = count == 0   ? "no warnings"
                              : count == 1 ? "1 warning"
                                           : std::to_string(count) + " warnings";
  return {{"verdict", verdict}, {"sentence", count > 0 ? json(first) : json()}};
}

std::string error_line(const std::filesystem::path& document, const std::filesystem::path& log) {
  std::error_code ignored;
  std::string damage;
  if (std::filesystem::is_regular_file(document, ignored)) {
    const auto told = parse_json(read_text(document), damage);
    const json message = told ? value_in(value_in(*told, "error"), "message") : json();
    if (message.is_string()) return first_line(message);
  }
  std::ifstream lines(log);
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  return last;
}

}  // namespace hookeye
