// How large a set of points is, the same in every frame.
#pragma once

#include <Eigen/Core>

namespace hookeye {

/// The longest of the distances from point to farthest point, walked from the points' mean until
/// none is longer [length]. Of a box it is the diagonal. (That of a bounding box grows by up to a
/// third when a bar is turned.)
double extent(const Eigen::Matrix3Xd& X);

}  // namespace hookeye
