// Kinds of cameras: how points map to the plane before the sensor, and back. One file a kind,
// cameras/NAME.cpp.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hookeye {

/// One kind of camera. With the camera's own fx, fy, cx, cy and skew
///   pixel = (fx u + skew v + cx, fy v + cy),  (u, v) = to_plane(lens, x):
/// x in camera axes (x right, y down, z forward) [length], `lens` the camera's `distortion`.
/// A model has no state and lives as long as the program.
///
/// A new one is a file cameras/NAME.cpp that ends with HOOKEYE_DEFINE_CAMERA(NAME, Class), and the
/// line HOOKEYE_CAMERA(NAME) in cameras/catalogue.def; the contract tests run over the catalogue.
class CameraModel {
 public:
  using Lens = std::vector<double>;
  using Jacobian3 = Eigen::Matrix<double, 2, 3>;
  struct LensNumber {
    std::string name, unit;
  };

  virtual ~CameraModel() = default;
  virtual std::string name() const = 0;  ///< `projection: NAME` in capture.yaml
  /// All rays pass through the origin of the camera axes; else all are parallel to z. The renderer
  /// knows these two.
  virtual bool central() const = 0;
  /// Whether lines stay straight: (u, v) = (x, y) / z, or (x, y) where rays are parallel.
  virtual bool linear(const Lens& lens) const = 0;

  /// d_dx [1/length] and d_dlens (2 x numbers of the lens) where asked; all NaN where the camera
  /// cannot see the point.
  virtual Eigen::Vector2d to_plane(const Lens& lens, const Eigen::Vector3d& x, Jacobian3* d_dx,
                                   Eigen::Matrix2Xd* d_dlens) const = 0;
  /// The ray h of a point of the plane: t (h, 1), t > 0, of a central camera; (h, t) where rays are
  /// parallel. To rounding; NaN where there is none.
  virtual Eigen::Vector2d ray(const Lens& lens, const Eigen::Vector2d& plane) const = 0;
  /// What a unit of the plane measures across the line of sight at x [length].
  virtual double unit_at(const Lens& lens, const Eigen::Vector3d& x) const = 0;

  /// All numbers that the lens may have, in order.
  virtual std::vector<LensNumber> lens_numbers() const = 0;
  /// Whether a lens may be told by its first `count` numbers.
  virtual bool takes(size_t count) const = 0;
  /// What is right, for those who gave another count; who gave a lens whose pixels have no rays;
  /// who left numbers out.
  virtual std::string count_rule() const = 0;
  virtual std::string ray_rule() const = 0;
  virtual std::string example() const = 0;
};

/// All of the catalogue; the first is the default.
const std::vector<const CameraModel*>& camera_models();
/// By its name; null where there is none.
const CameraModel* find_camera_model(const std::string& name);
/// By its name, which the catalogue has.
const CameraModel& camera_model(const std::string& name);

}  // namespace hookeye

#define HOOKEYE_DEFINE_CAMERA(NAME, CLASS)   \
  namespace hookeye {                        \
  const CameraModel& camera_model_##NAME() { \
    static const CLASS model;                \
    return model;                            \
  }                                          \
  }
