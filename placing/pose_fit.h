// The pose of the body by least squares over whatever says where its points are (Ceres).
#pragma once

#include <Eigen/Geometry>
#include <functional>

namespace hookeye {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
/// Derivative of a moved point by a small turn [rad] about the moved middle of the body and by a
/// shift of it [length], both along the axes of the frame that the pose leads into.
using PointJacobian = Eigen::Matrix<double, 3, 6>;

PointJacobian point_jacobian(const Isometry3d& pose, const Vector3d& middle, const Vector3d& X);

/// Residuals in groups of `size` numbers: group i at a pose, and their derivative (size x 6, by the
/// numbers of PointJacobian; may be null). False: there is no residual at this pose.
struct PoseTerms {
  int count = 0;
  int size = 1;
  Vector3d middle = Vector3d::Zero();  ///< of the body, before the pose [length]
  std::function<bool(int i, const Isometry3d& pose, double* r, double* J)> term;
};

struct PoseFit {
  Isometry3d pose = Isometry3d::Identity();
  double cost = 0.0;  ///< half the sum of squares, or of what `loss` makes of them
  bool good = false;  ///< false: the start has no residual, or a number is not finite
};

/// From `start` downhill. `loss`: groups of residuals beyond it count less (Cauchy); 0: all alike.
PoseFit fit_pose(const Isometry3d& start, const PoseTerms& terms, double loss, int iterations);

/// J^T J of the groups at a pose, those beyond `loss` weighed down as the fit does.
Matrix6d information_of(const Isometry3d& pose, const PoseTerms& terms, double loss);

}  // namespace hookeye
