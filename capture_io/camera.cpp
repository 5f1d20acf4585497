#include "capture_io/camera.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "capture_io/distortion.h"

namespace hookeye {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

Eigen::Vector2d Camera::project(const Eigen::Vector3d& x_in_world) const {
  return project(x_in_world, nullptr, nullptr);
}

Eigen::Vector2d Camera::project(const Eigen::Vector3d& x_in_world, Jacobian3* d_dx,
                                Jacobian7* d_dcamera) const {
  const Eigen::Vector3d x = R * x_in_world + t;
  const Eigen::Vector2d f(fx, fy);
  Eigen::Vector2d plane;                  // distorted normalised coordinates
  Eigen::Matrix<double, 2, 3> dplane_dx;  // by camera coordinates
  if (projection == Projection::orthographic) {
    plane = x.head<2>();
    dplane_dx << 1, 0, 0, 0, 1, 0;
  } else {
    if (!(x.z() > 0)) {
      const double nan = std::numeric_limits<double>::quiet_NaN();
      if (d_dx) d_dx->setConstant(nan);
      if (d_dcamera) d_dcamera->setConstant(nan);
      return {nan, nan};
    }
    const Eigen::Vector2d ideal = x.head<2>() / x.z();
    dplane_dx << 1 / x.z(), 0, -ideal.x() / x.z(), 0, 1 / x.z(), -ideal.y() / x.z();
    plane = ideal;
    if (!distortion.empty()) {
      Eigen::Matrix2d d_dideal;
      plane = distort(distortion, ideal, &d_dideal);
      dplane_dx = (d_dideal * dplane_dx).eval();
    }
  }
  const Jacobian3 dpixel_dx = f.asDiagonal() * dplane_dx;
  const Eigen::Vector2d from_centre = f.cwiseProduct(plane);
  if (d_dx) *d_dx = dpixel_dx * R;
  if (d_dcamera) {
    // x' = exp([w]x) x + v: dx'/dw = -[x]x at w = 0.
    d_dcamera->leftCols<3>() = -dpixel_dx * cross_matrix(x);
    d_dcamera->middleCols<3>(3) = dpixel_dx;
    d_dcamera->col(6) = from_centre;
  }
  return from_centre + Eigen::Vector2d(cx, cy);
}

Ray Camera::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d plane((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (projection == Projection::orthographic)
    return {R.transpose() * (Eigen::Vector3d(plane.x(), plane.y(), 0) - t),
            R.transpose() * Eigen::Vector3d::UnitZ()};
  const Eigen::Vector2d ideal = distortion.empty() ? plane : undistort(distortion, plane);
  return {centre(), R.transpose() * Eigen::Vector3d(ideal.x(), ideal.y(), 1).normalized()};
}

Camera Camera::moved(const Eigen::Vector3d& w_rad, const Eigen::Vector3d& v) const {
  Camera result = *this;
  const double angle = w_rad.norm();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (angle > 0) turn = Eigen::AngleAxisd(angle, w_rad / angle).toRotationMatrix();
  result.R = turn * R;
  result.t = turn * t + v;
  return result;
}

Camera Camera::zoomed(double log_factor) const {
  Camera result = *this;
  result.fx *= std::exp(log_factor);
  result.fy *= std::exp(log_factor);
  return result;
}

}  // namespace hookeye
