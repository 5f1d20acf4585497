// What to photograph next, as product.md's JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/plan/plan.h"

namespace hookeye {

nlohmann::json to_json(const Plan& plan);

}  // namespace hookeye
