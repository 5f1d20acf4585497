// What was added to a model, in numbers with their intervals, as people read them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace hookeye {

/// Of a step of run.json: [{effect, says, values: [{name, value, low, high, unit, long_name}]}] of
/// its effects with fitted numbers, in their order. A logarithm of a factor is told as the factor.
nlohmann::json effect_values(const nlohmann::json& step);

/// "; 95 % interval of the factor 2.91 to 3.07" of an effect of them whose sentence names one
/// factor; "" of others.
std::string factor_interval(const nlohmann::json& effects, const std::string& effect);

}  // namespace hookeye
