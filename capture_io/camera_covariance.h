// How well the numbers of a capture's cameras are known: `camera_covariance: FILE`.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "capture_io/yaml_section.h"

namespace hookeye {

/// Covariance of numbers of cameras about those that the capture has; all other numbers are exact.
/// A number is one of Camera::intrinsics(), or `rotation_x` .. `shift_z`: a small motion in the
/// camera's own axes, as Camera::moved() takes it. So a world that is turned, moved or given anew
/// (`body: placement`) leaves it as it is.
struct CameraCovariance {
  struct Number {
    std::string camera, name;
  };
  std::vector<Number> numbers;         ///< those of one camera together
  Eigen::MatrixXd values;              ///< in the capture's units
  std::string told;                    ///< the file's name for messages
  Place place;                         ///< of the key that names it
  std::vector<std::string> strangers;  ///< cameras of the file that the capture lacks: left out

  /// Those with numbers, in their order.
  std::vector<std::string> cameras() const;
  double deviation(size_t i) const;
};

/// As `hookeye calibrate` names it, beside cameras.yaml.
inline constexpr const char* kCovarianceFile = "camera_covariance.yaml";

/// A fitted model has as many numbers a camera: a turn, a shift and a zoom (Camera::Jacobian7).
inline constexpr int kCalibratedNumbers = 7;

/// Fills camera_covariance of a capture whose units and cameras are known. Throws InputError.
void read_camera_covariance(const YamlNode& node, const CaptureFolder& folder, Capture& capture);
/// Once the examples are known: only cameras with a fitted photo are left in it (null: none), and
/// the first example that has one measures them (MeasuredSpec::Kind::calibration).
void measure_calibration(Capture& capture);

/// The file's text: `head`, then all. `unit`: of its lengths. Numbers whose variance is zero are
/// given ones, like the pose of the camera that is the world, and are left out.
std::string camera_covariance_text(const CameraCovariance& covariance, const std::string& unit,
                                   const std::string& head);

}  // namespace hookeye
