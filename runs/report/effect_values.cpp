#include "runs/report/effect_values.h"

#include <cmath>

namespace hookeye {

using nlohmann::json;

namespace {

std::string text_in(const json& object, const char* key) {
  return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
}

/// "stiffness factor" of "log of the stiffness factor"; "" where it is no such logarithm.
std::string factor_in(const std::string& long_name) {
  const std::string log = "log of the ";
  return long_name.starts_with(log) ? long_name.substr(log.size()) : "";
}

/// One parameter without its effect's name, a logarithm as the factor that people think in.
json value_of(const json& parameter, const std::string& effect) {
  json out = parameter;
  out["name"] = text_in(parameter, "name").substr(effect.size() + 1);
  const std::string factor = factor_in(text_in(parameter, "long_name"));
  if (factor.empty() || !text_in(parameter, "unit").empty()) return out;
  for (const char* key : {"value", "low", "high"})
    if (out.contains(key) && out[key].is_number()) out[key] = std::exp(out[key].get<double>());
  out["long_name"] = factor;
  out["factor"] = true;
  return out;
}

}  // namespace

json effect_values(const json& step) {
  json out = json::array();
  for (const json& name : step.value("effects", json::array())) {
    if (!name.is_string()) continue;
    const std::string effect = name, prefix = effect + ".";
    json one = {{"effect", effect}, {"says", ""}, {"values", json::array()}};
    for (const json& said : step.value("says", json::array()))
      if (said.is_string() && said.get<std::string>().starts_with(effect + ": "))
        one["says"] = said.get<std::string>().substr(effect.size() + 2);
    for (const json& parameter : step.value("parameters", json::array()))
      if (parameter.is_object() && text_in(parameter, "name").starts_with(prefix))
        one["values"].push_back(value_of(parameter, effect));
    if (!one["values"].empty()) out.push_back(std::move(one));
  }
  return out;
}

}  // namespace hookeye
