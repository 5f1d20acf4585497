// The capture's unit of force in SI.
#pragma once

#include "capture_io/capture.h"

namespace hookeye {

/// Newtons in one unit of force.
double newtons(const Units& units);

}  // namespace hookeye
