// Cameras with OpenCV's conventions: x right, y down, z forward; pixel centres at integers.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "capture_io/camera_model.h"
#include "core/input_error.h"

namespace hookeye {

struct Ray {
  Eigen::Vector3d origin;     ///< world [length]
  Eigen::Vector3d direction;  ///< world, unit
};

/// A number of a camera other than its size and pose.
struct Intrinsic {
  std::string name;  ///< as in capture.yaml; those of the lens as OpenCV calls them
  std::string unit;  ///< "": none; "length" stands for the capture's
  double value = 0;
};

struct Camera {
  std::string name;
  int width = 0, height = 0;  ///< [px]
  const CameraModel* model = camera_models().front();
  double fx = 0, fy = 0;  ///< [px]; where rays are parallel px per length unit
  double cx = 0, cy = 0;  ///< [px]
  double skew = 0;        ///< entry (0, 1) of the camera matrix, in the unit of fx
  /// The numbers of the model's lens. Perspective: OpenCV's order k1 k2 p1 p2 k3 (k4 k5 k6 (s1 s2
  /// s3 s4 (tx ty))); fisheye: k1 k2 k3 k4; empty: none.
  std::vector<double> distortion;
  /// Brightness falls as 1 / (1 + vignetting tan^2 a)^2 at the angle a to the axis: 0 not at all, 1
  /// as cos^4 a. Of central cameras.
  double vignetting = 0;
  /// log of how much larger the red and the blue picture are than the green one, about (cx, cy).
  Eigen::Vector2d colour_zoom = Eigen::Vector2d::Zero();
  bool fit_vignetting = false, fit_colour_zoom = false;  ///< not told
  Place lens_place;                                      ///< where one of these stands
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();       ///< camera_from_world rotation
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< x_in_camera = R x_in_world + t [length]

  using Jacobian3 = Eigen::Matrix<double, 2, 3>;
  using Jacobian7 = Eigen::Matrix<double, 2, 7>;

  /// Pixel of a world point. NaN where the camera cannot see it, as behind a central one.
  Eigen::Vector2d project(const Eigen::Vector3d& x_in_world) const;
  /// The same with derivatives: d_dx by the world point [px/length]; d_dcamera by the camera's own
  /// seven numbers (moved(), zoomed()): w [rad] (3), v [length] (3), log focal length.
  Eigen::Vector2d project(const Eigen::Vector3d& x_in_world, Jacobian3* d_dx,
                          Jacobian7* d_dcamera) const;
  /// Derivative of the pixel by intrinsics(), column by column.
  Eigen::Matrix2Xd d_dintrinsics(const Eigen::Vector3d& x_in_world) const;
  /// fx, fy, cx, cy, skew, and the numbers of the lens.
  std::vector<Intrinsic> intrinsics() const;
  /// Ray through a pixel, the lens undone to rounding. NaN where the pixel has none.
  Ray ray(const Eigen::Vector2d& pixel) const;
  /// Depth along the optical axis [length].
  double depth(const Eigen::Vector3d& x_in_world) const { return (R * x_in_world + t).z(); }
  /// What a pixel measures across the line of sight at a point [length].
  double length_per_px(const Eigen::Vector3d& x_in_world) const;
  /// Whether lines stay straight and pixels upright: the pixel is (fx u + cx, fy v + cy) with
  /// (u, v) = (x, y) / z, or (x, y) where rays are parallel.
  bool straight() const { return skew == 0 && model->linear(distortion); }
  /// Whether size, model and intrinsics are the same.
  bool same_optics(const Camera& other) const;
  /// Viewing position of a central camera [length].
  Eigen::Vector3d centre() const { return -R.transpose() * t; }

  /// x_in_camera' = exp([w]x) (R x + t) + v: a small motion in camera axes.
  Camera moved(const Eigen::Vector3d& w_rad, const Eigen::Vector3d& v) const;
  /// fx, fy and skew times exp(log_factor).
  Camera zoomed(double log_factor) const;
  /// That of one of the colours red, green and blue.
  Camera of_colour(int colour) const;
  /// Intrinsics of the same picture with `factor` times as many pixels along its sides; leaves
  /// `width` and `height`. Pixel centres are integers: coordinate c becomes (c + 1/2) factor - 1/2.
  Camera resized(double factor) const;
};

/// Its `intrinsics` as capture.yaml has them, {fx: .., fy: .., ..}: what is zero is left out.
std::string intrinsics_text(const Camera& camera, const std::function<std::string(double)>& number);

/// Reads fx.. distortion, size and, where present, pose from an OpenCV FileStorage file (yml, xml,
/// json; keys camera_matrix / K, distortion_coefficients / D, fisheye_model, image_width, R, T
/// ...). OpenCV's reader runs in a helper (helpers/calibration.cpp). Throws InputError. `has_pose`
/// receives whether the file holds R and T.
Camera read_opencv_calibration(const std::filesystem::path& file, bool* has_pose = nullptr);

}  // namespace hookeye
