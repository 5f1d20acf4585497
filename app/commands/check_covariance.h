// What `check` says of how well cameras are known.
#pragma once

#include <nlohmann/json.hpp>

#include "app/session.h"
#include "capture_io/capture.h"

namespace hookeye {

/// Null where the capture has no `camera_covariance`.
nlohmann::ordered_json describe_covariance(const Capture& capture);
/// "known as FILE has them: left to 0.01 degrees, .."; nothing of null.
void say_covariance(const nlohmann::ordered_json& described, const Units& units,
                    const Session& session);

}  // namespace hookeye
