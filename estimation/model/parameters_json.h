// Parameters with their values, as run.json and its neighbours have them.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/parameter.h"

namespace hookeye {

/// Name, unit, words and value of each; `low` and `high` where they are told.
nlohmann::json parameters_json(const std::vector<Parameter>& parameters,
                               const Eigen::VectorXd& value, const Eigen::VectorXd* low,
                               const Eigen::VectorXd* high);

}  // namespace hookeye
