#include "calibration/turns.h"

#include <Eigen/Geometry>
#include <cmath>

namespace hookeye::detail {

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d out;
  out << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return out;
}

Eigen::Matrix3d turn(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  if (angle == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  const Eigen::Matrix3d X = cross(r);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + X / 2 + X * X / 6;  // to angle^3
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / square * X +
         (angle - std::sin(angle)) / (square * angle) * X * X;
}

Eigen::Matrix<double, 6, 6> motion_of_pose(const Eigen::Matrix<double, 6, 1>& pose) {
  // w = J dr; the shift is turned with the rest: t + dt = t + w x t + v.
  Eigen::Matrix<double, 6, 6> out = Eigen::Matrix<double, 6, 6>::Zero();
  const Eigen::Matrix3d J = left_jacobian(pose.head<3>());
  out.topLeftCorner<3, 3>() = J;
  out.bottomLeftCorner<3, 3>() = cross(pose.tail<3>()) * J;
  out.bottomRightCorner<3, 3>().setIdentity();
  return out;
}

}  // namespace hookeye::detail
