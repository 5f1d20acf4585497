// Where the body lies in the frame of the cameras: what every way of finding it hands back.
#pragma once

#include <string>
#include <vector>

#include "capture_io/placement.h"
#include "meshing/surface_mesh.h"
#include "placing/pose_fit.h"

namespace hookeye {

/// The body as it is looked for: its surface, and a few numbers of it.
struct PlacedBody {
  const SurfaceMesh* surface = nullptr;                ///< at rest, outward
  Vector3d middle = Vector3d::Zero();                  ///< of its area
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: principal, the longest first
  Vector3d spread = Vector3d::Zero();                  ///< standard deviation along them [length]
  double extent = 0.0;                                 ///< its largest diameter [length]
  std::string length;                                  ///< name of the unit
};
PlacedBody placed_body(const SurfaceMesh& surface, const std::string& length);

/// Another place that the same data allow.
struct OtherPlace {
  Isometry3d motion = Isometry3d::Identity();  ///< as Placing::motion
  double misfit = 0.0;                         ///< as Placing::misfit
};

struct Placing {
  /// From where the capture tells the body to where it was found, in the body's frame as told.
  Isometry3d motion = Isometry3d::Identity();
  double misfit = 0.0;      ///< root mean square of what is left ...
  std::string misfit_unit;  ///< ... in this unit
  /// Of a turn [rad] about the moved middle of the body and of its shift [length], along the axes
  /// of the body's frame as told.
  Matrix6d covariance = Matrix6d::Zero();
  std::vector<OtherPlace> others;     ///< that fit as well
  std::vector<std::string> said;      ///< what the user is to know
  std::vector<std::string> warnings;  ///< what makes it doubtful
};

/// How far a motion turns [rad], and how far it shifts the body's middle [length].
double angle_of(const Isometry3d& motion);
double shift_of(const Isometry3d& motion, const Vector3d& middle);
/// Whether two places are apart by more than `radians` or `length`.
bool apart(const Isometry3d& a, const Isometry3d& b, const Vector3d& middle, double radians,
           double length);

/// Fills `covariance` from J^T J in units of standard deviations. Warns of a motion that the data
/// leave open, which is then given the error of the body's size.
void set_errors(const Matrix6d& information, const PlacedBody& body, Placing* placing);

/// Warns of the places in `others`.
void warn_of_others(const PlacedBody& body, Placing* placing);

/// `told` after the motion was found: what capture.yaml is to tell.
ToldPlacement placed(const ToldPlacement& told, const Isometry3d& motion);

/// Half-turns about the principal axes, and quarter turns about those across which the body is
/// about as wide: what bodies look alike under.
std::vector<Isometry3d> likely_symmetries(const PlacedBody& body);

/// All 24 ways to lay a cube's axes onto themselves.
std::vector<Eigen::Matrix3d> cube_turns();

}  // namespace hookeye
