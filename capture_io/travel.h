// How far a support takes its region.
#pragma once

#include "capture_io/capture.h"

namespace hookeye {

/// Its displacement [length], in the body's frame; of what also turns, the move after the turn;
/// zero where nothing moves or the motion is fitted.
Eigen::Vector3d prescribed_travel(const SupportSpec& support);

}  // namespace hookeye
