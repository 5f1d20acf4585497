// The body pushed or turned as a camera sees it.
#pragma once

#include "capture_io/camera.h"
#include "capture_io/placement.h"

namespace hookeye {

/// `told` with the body moved by `move` [length] and turned by `turn` [rad, about `middle`, a point
/// of the body], both along the axes of `camera`, whose pose is in the body's frame as
/// read_capture() leaves it.
ToldPlacement nudged(const ToldPlacement& told, const Camera& camera, const Eigen::Vector3d& move,
                     const Eigen::Vector3d& turn, const Eigen::Vector3d& middle);

}  // namespace hookeye
