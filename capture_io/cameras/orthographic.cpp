// Parallel rays: a telecentric lens, or a camera so far away that it seems one.
#include <algorithm>

#include "capture_io/camera_model.h"
#include "capture_io/distortion.h"

namespace hookeye {
namespace {

/// The plane is the body's own, in its length: fx and fy are in px per length unit, and distortion
/// takes lengths where a pinhole's takes x/z. A tilted sensor needs none of its own: it is fx
/// against fy, and skew.
class Orthographic final : public CameraModel {
 public:
  std::string name() const override { return "orthographic"; }
  bool central() const override { return false; }
  bool linear(const Lens& lens) const override {
    return std::all_of(lens.begin(), lens.end(), [](double k) { return k == 0; });
  }

  Eigen::Vector2d to_plane(const Lens& lens, const Eigen::Vector3d& x, Jacobian3* d_dx,
                           Eigen::Matrix2Xd* d_dlens) const override {
    const Eigen::Vector2d ideal = x.head<2>();
    if (d_dx) *d_dx << 1, 0, 0, 0, 1, 0;
    if (d_dlens) *d_dlens = distortion_derivative(lens, ideal);
    if (lens.empty()) return ideal;
    Eigen::Matrix2d d_dideal;
    const Eigen::Vector2d plane = distort(lens, ideal, &d_dideal);
    if (d_dx) d_dx->leftCols<2>() = d_dideal;
    return plane;
  }

  Eigen::Vector2d ray(const Lens& lens, const Eigen::Vector2d& plane) const override {
    return lens.empty() ? plane : undistort(lens, plane);
  }
  double unit_at(const Lens&, const Eigen::Vector3d&) const override { return 1.0; }

  std::vector<LensNumber> lens_numbers() const override {
    return {{"k1", "1/length^2"}, {"k2", "1/length^4"}, {"p1", "1/length"},   {"p2", "1/length"},
            {"k3", "1/length^6"}, {"k4", "1/length^2"}, {"k5", "1/length^4"}, {"k6", "1/length^6"},
            {"s1", "1/length"},   {"s2", "1/length^3"}, {"s3", "1/length"},   {"s4", "1/length^3"}};
  }
  bool takes(size_t count) const override {
    return count == 0 || count == 4 || count == 5 || count == 8 || count == 12;
  }
  std::string count_rule() const override {
    return "0, 4, 5, 8 or 12 are expected, in OpenCV's order, for lengths in place of x/z (k1 in "
           "1/length^2)";
  }
  std::string ray_rule() const override {
    return "look at its coefficients, which take lengths in place of x/z (k1 in 1/length^2), and "
           "at scale";
  }
  std::string example() const override {
    return "write `intrinsics: {scale: 10, cx: 399.5, cy: 299.5}`";
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_CAMERA(orthographic, Orthographic)
