// A pinhole with OpenCV's distortion (calib3d, cv::projectPoints).
#include <algorithm>
#include <limits>

#include "capture_io/camera_model.h"
#include "capture_io/distortion.h"

namespace hookeye {
namespace {

class Perspective final : public CameraModel {
 public:
  std::string name() const override { return "perspective"; }
  bool central() const override { return true; }
  bool linear(const Lens& lens) const override {
    return std::all_of(lens.begin(), lens.end(), [](double k) { return k == 0; });
  }

  Eigen::Vector2d to_plane(const Lens& lens, const Eigen::Vector3d& x, Jacobian3* d_dx,
                           Eigen::Matrix2Xd* d_dlens) const override {
    if (!(x.z() > 0)) {
      const double nan = std::numeric_limits<double>::quiet_NaN();
      if (d_dx) d_dx->setConstant(nan);
      if (d_dlens) d_dlens->setConstant(2, static_cast<Eigen::Index>(lens.size()), nan);
      return {nan, nan};
    }
    const Eigen::Vector2d ideal = x.head<2>() / x.z();
    if (d_dx) *d_dx << 1 / x.z(), 0, -ideal.x() / x.z(), 0, 1 / x.z(), -ideal.y() / x.z();
    if (d_dlens) *d_dlens = distortion_derivative(lens, ideal);
    if (lens.empty()) return ideal;
    Eigen::Matrix2d d_dideal;
    const Eigen::Vector2d plane = distort(lens, ideal, &d_dideal);
    if (d_dx) *d_dx = (d_dideal * *d_dx).eval();
    return plane;
  }

  Eigen::Vector2d ray(const Lens& lens, const Eigen::Vector2d& plane) const override {
    return lens.empty() ? plane : undistort(lens, plane);
  }
  double unit_at(const Lens&, const Eigen::Vector3d& x) const override { return x.z(); }

  std::vector<LensNumber> lens_numbers() const override {
    return {{"k1", ""}, {"k2", ""}, {"p1", ""},    {"p2", ""},   {"k3", ""},
            {"k4", ""}, {"k5", ""}, {"k6", ""},    {"s1", ""},   {"s2", ""},
            {"s3", ""}, {"s4", ""}, {"tx", "rad"}, {"ty", "rad"}};
  }
  bool takes(size_t count) const override {
    return count == 0 || count == 4 || count == 5 || count == 8 || count == 12 || count == 14;
  }
  std::string count_rule() const override {
    return "0, 4, 5, 8, 12 or 14 are expected, in OpenCV's order";
  }
  std::string ray_rule() const override {
    return "look at its coefficients (OpenCV's order: k1, k2, p1, p2, k3 ...) and at fx";
  }
  std::string example() const override {
    return "write `intrinsics: {fx: 1100, fy: 1100, cx: 399.5, cy: 299.5}`";
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_CAMERA(perspective, Perspective)
