// How far measured values are met, in words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace hookeye {

/// "; measured values are met to 0.9 of their sigma (RMS of 6 components)", and of which is far off
/// what its numbers fit: the weight of the body, a zero, or another sign or unit. "": nothing is
/// measured. `metrics`: a step's metrics.json.
std::string met_values(const nlohmann::json& metrics);

}  // namespace hookeye
