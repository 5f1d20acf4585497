// Rotation vectors and what they move.
#pragma once

#include <Eigen/Core>

namespace hookeye::detail {

/// [v]x: cross(v) w = v x w.
Eigen::Matrix3d cross(const Eigen::Vector3d& v);
/// exp([r]x).
Eigen::Matrix3d turn(const Eigen::Vector3d& r);
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R);
/// exp([r + dr]x) = exp([J dr]x) exp([r]x) for small dr.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& r);
/// From a change of (rotation vector, shift) to the w, v of Camera::moved().
Eigen::Matrix<double, 6, 6> motion_of_pose(const Eigen::Matrix<double, 6, 1>& pose);

}  // namespace hookeye::detail
