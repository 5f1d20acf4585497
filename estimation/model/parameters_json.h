// Parameters with their values, as run.json and its neighbours have them.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/parameter.h"

namespace hookeye {

/// Ends of an interval, no farther than the parameter goes: a place lies in the body. (Intervals
/// are linear, and where a value hardly matters they reach beyond.)
std::pair<double, double> interval_within(const Parameter& parameter, double low, double high);

/// Name, unit, words and value of each; `low` and `high`, within the bounds, where they are told.
nlohmann::json parameters_json(const std::vector<Parameter>& parameters,
                               const Eigen::VectorXd& value, const Eigen::VectorXd* low,
                               const Eigen::VectorXd* high);

}  // namespace hookeye
