// What the body weighs, where the model leaves it out.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/fit/fit.h"

namespace hookeye {

/// metrics.json, `weight`: {told, of_water, unit}: the body's weight on earth by the capture's
/// density (null: it tells none) and by that of water [force]. Null where the model has gravity, or
/// where no force on a support was measured.
nlohmann::json own_weight(const Scene& scene, const Fitted& fitted);

}  // namespace hookeye
