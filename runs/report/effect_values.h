// What was added to a model, in numbers with their intervals, as people read them.
#pragma once

#include <nlohmann/json.hpp>

namespace hookeye {

/// Of a step of run.json: [{effect, says, values: [{name, value, low, high, unit, long_name}]}] of
/// its effects with fitted numbers, in their order. A logarithm of a factor is told as the factor.
nlohmann::json effect_values(const nlohmann::json& step);

}  // namespace hookeye
