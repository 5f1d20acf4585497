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

/// A coordinate of a place's centre whose interval, within the bounds, takes more than half of the
/// body: where along that axis it is, is not known.
bool centre_is_unknown(const Parameter& parameter, double low, double high);

/// Name, unit, words and value of each; `low` and `high`, within the bounds, where they are told;
/// `known: open` of a centre that is unknown.
nlohmann::json parameters_json(const std::vector<Parameter>& parameters,
                               const Eigen::VectorXd& value, const Eigen::VectorXd* low,
                               const Eigen::VectorXd* high);

}  // namespace hookeye
