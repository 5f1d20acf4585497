// What the page tells about the capture and about how the pictures were matched.
#pragma once

#include <nlohmann/json.hpp>

#include "capture_io/capture.h"

namespace hookeye {

nlohmann::json capture_facts(const Capture& capture);

/// The table that good practice in digital image correlation asks for (iDICs, A Good Practices
/// Guide for Digital Image Correlation, 2018, "Reporting requirements"): [{name, value}]. What
/// depends on a step (floor, mesh) is added by the page from metrics.json.
nlohmann::json reporting_table(const Capture& capture);

}  // namespace hookeye
