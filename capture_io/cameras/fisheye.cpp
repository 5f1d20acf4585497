// OpenCV's fisheye (cv::fisheye; Kannala and Brandt 2006): the distance from the axis in the plane
// is a polynomial of the angle to it, r = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4
// theta^8). Its skew alpha is the camera's skew over fx.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "capture_io/camera_model.h"

namespace hookeye {
namespace {

/// Rays are (h, 1) with h = tan(theta): further out they would meet what lies beside the camera.
constexpr double kWidest = 89 * EIGEN_PI / 180;  // [rad]
/// So near to the axis theta and its tangent are the same double.
constexpr double kOnAxis = 1e-8;

/// The distance from the axis in the plane, by the angle.
class Radius {
 public:
  explicit Radius(const CameraModel::Lens& lens) {
    for (size_t i = 0; i < std::min(lens.size(), k_.size()); ++i) k_[i] = lens[i];
  }
  double at(double theta) const {
    const double t = theta * theta;
    return theta * (1 + t * (k_[0] + t * (k_[1] + t * (k_[2] + t * k_[3]))));
  }
  double slope(double theta) const {
    const double t = theta * theta;
    return 1 + t * (3 * k_[0] + t * (5 * k_[1] + t * (7 * k_[2] + t * 9 * k_[3])));
  }
  double angle_of(double r) const;

 private:
  std::array<double, 4> k_{};
};

/// NaN where the polynomial turns back, or leaves the range of angles, before it reaches r: rays
/// are those of the branch that contains the axis.
double Radius::angle_of(double r) const {
  constexpr int kSteps = 32;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  double low = 0, high = 0;
  for (int i = 1; i <= kSteps; ++i) {
    low = high, high = kWidest * i / kSteps;
    if (at(high) >= r) break;
    if (i == kSteps || !(slope(high) > 0)) return nan;
  }
  // Newton's steps, halving the bracket where they leave it.
  double theta = std::min(std::max(r, low), high);
  for (int i = 0; i < 100; ++i) {
    const double miss = at(theta) - r;
    (miss > 0 ? high : low) = theta;
    double next = theta - miss / slope(theta);
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    const double step = std::abs(next - theta);
    theta = next;
    if (step <= 1e-15 * theta) break;
  }
  return std::abs(at(theta) - r) <= 1e-12 * (1 + r) && slope(theta) > 0 ? theta : nan;
}

class Fisheye final : public CameraModel {
 public:
  std::string name() const override { return "fisheye"; }
  bool central() const override { return true; }
  bool linear(const Lens&) const override { return false; }

  Eigen::Vector2d to_plane(const Lens& lens, const Eigen::Vector3d& x, Jacobian3* d_dx,
                           Eigen::Matrix2Xd* d_dlens) const override {
    const Radius radius(lens);
    const Eigen::Vector2d across = x.head<2>();
    const double beside = across.norm(), theta = std::atan2(beside, x.z());
    const double slope = radius.slope(theta);
    const auto numbers = static_cast<Eigen::Index>(lens.size());
    if (!(x.z() > 0) || !(slope > 0)) {  // behind the camera, or where the polynomial turns back
      const double nan = std::numeric_limits<double>::quiet_NaN();
      if (d_dx) d_dx->setConstant(nan);
      if (d_dlens) d_dlens->setConstant(2, numbers, nan);
      return {nan, nan};
    }
    const bool on_axis = beside <= kOnAxis * x.z();
    const double scale = on_axis ? 1 / x.z() : radius.at(theta) / beside;
    if (d_dx) {
      // The plane's point is scale (x, y); theta' = z/d^2 by the distance from the axis, -|x y|/d^2
      // by the depth, d the distance.
      const double d2 = x.squaredNorm(), by_beside = slope * x.z() / d2;
      d_dx->leftCols<2>() = scale * Eigen::Matrix2d::Identity();
      if (!on_axis)
        d_dx->leftCols<2>() +=
            (by_beside - scale) / (beside * beside) * across * across.transpose();
      d_dx->col(2) = -slope / d2 * across;
    }
    if (d_dlens) {
      d_dlens->setZero(2, numbers);
      double power = theta * theta * theta;
      for (Eigen::Index i = 0; i < numbers && !on_axis; ++i, power *= theta * theta)
        d_dlens->col(i) = power / beside * across;
    }
    return scale * across;
  }

  Eigen::Vector2d ray(const Lens& lens, const Eigen::Vector2d& plane) const override {
    const double r = plane.norm();
    if (r <= kOnAxis) return plane;
    return std::tan(Radius(lens).angle_of(r)) / r * plane;
  }

  /// The geometric mean of its sizes along and across the radius.
  double unit_at(const Lens& lens, const Eigen::Vector3d& x) const override {
    const Radius radius(lens);
    const double beside = x.head<2>().norm(), d = x.norm(), theta = std::atan2(beside, x.z());
    if (beside <= kOnAxis * d) return d;
    return d / std::sqrt(radius.slope(theta) * radius.at(theta) * d / beside);
  }

  std::vector<LensNumber> lens_numbers() const override {
    return {{"k1", ""}, {"k2", ""}, {"k3", ""}, {"k4", ""}};
  }
  bool takes(size_t count) const override { return count == 0 || count == 4; }
  std::string count_rule() const override {
    return "0 or 4 are expected: k1, k2, k3, k4 of cv::fisheye, which has no tangential terms";
  }
  std::string ray_rule() const override {
    return "rays are followed up to 89 degrees off the axis, where k1 .. k4 let the radius grow: "
           "look at them and at fx, or crop the photos (and `size`, `cx`, `cy` with them)";
  }
  std::string example() const override {
    return "write `intrinsics: {fx: 400, fy: 400, cx: 399.5, cy: 299.5, distortion: [0, 0, 0, 0]}`";
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_CAMERA(fisheye, Fisheye)
