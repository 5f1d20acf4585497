// Cameras with OpenCV's conventions: x right, y down, z forward; pixel centres at integers.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "capture_io/input_error.h"

namespace hookeye {

struct Ray {
  Eigen::Vector3d origin;     ///< world [length]
  Eigen::Vector3d direction;  ///< world, unit
};

struct Camera {
  enum class Projection { perspective, orthographic };

  std::string name;
  int width = 0, height = 0;  ///< [px]
  Projection projection = Projection::perspective;
  double fx = 0, fy = 0;  ///< [px]; orthographic: px per length unit
  double cx = 0, cy = 0;  ///< [px]
  /// OpenCV order k1 k2 p1 p2 k3 (k4 k5 k6 (s1 s2 s3 s4 (tx ty))); empty: none.
  std::vector<double> distortion;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< camera_from_world rotation
  Eigen::Vector3d t = Eigen::Vector3d::Zero();      ///< x_in_camera = R x_in_world + t [length]

  using Jacobian3 = Eigen::Matrix<double, 2, 3>;
  using Jacobian7 = Eigen::Matrix<double, 2, 7>;

  /// Pixel of a world point. Points behind a perspective camera give NaN.
  Eigen::Vector2d project(const Eigen::Vector3d& x_in_world) const;
  /// The same with derivatives: d_dx by the world point [px/length]; d_dcamera by the camera's own
  /// seven numbers (rotated_and_moved(), zoomed()): w [rad] (3), v [length] (3), log focal length.
  Eigen::Vector2d project(const Eigen::Vector3d& x_in_world, Jacobian3* d_dx,
                          Jacobian7* d_dcamera) const;
  /// Ray through a pixel (distortion undone by fixed-point then Newton to 1e-10).
  Ray ray(const Eigen::Vector2d& pixel) const;
  /// Depth along the optical axis [length].
  double depth(const Eigen::Vector3d& x_in_world) const { return (R * x_in_world + t).z(); }
  /// Viewing position (perspective) [length].
  Eigen::Vector3d centre() const { return -R.transpose() * t; }

  /// x_in_camera' = exp([w]x) (R x + t) + v: a small motion in camera axes.
  Camera moved(const Eigen::Vector3d& w_rad, const Eigen::Vector3d& v) const;
  /// fx, fy times exp(log_factor).
  Camera zoomed(double log_factor) const;
};

/// Reads fx.. distortion, size and, where present, pose from an OpenCV FileStorage file (yml, xml,
/// json; keys camera_matrix / K, distortion_coefficients / D, image_width, R, T ...).
/// OpenCV's reader runs in a helper (helpers/calibration.cpp). Throws InputError.
/// `has_pose` receives whether the file holds R and T.
Camera read_opencv_calibration(const std::filesystem::path& file, bool* has_pose = nullptr);

}  // namespace hookeye
