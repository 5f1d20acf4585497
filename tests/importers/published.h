// Projection as the other programs publish it, written out once more: what importers are held
// against. None of the program's own cameras is used here.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>
#include <random>

#include "importers/importer.h"

namespace hookeye::test {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// OpenCV, ROS plumb_bob and rational_polynomial, Kalibr radtan, COLMAP FULL_OPENCV: x/z, y/z to
/// the plane. k1 k2 p1 p2 k3 k4 k5 k6, those left out are zero.
inline Vector2d brown(const Vector3d& x, std::vector<double> k) {
  k.resize(8);
  const double u = x.x() / x.z(), v = x.y() / x.z(), r2 = u * u + v * v;
  const double radial =
      (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  return {u * radial + 2 * k[2] * u * v + k[3] * (r2 + 2 * u * u),
          v * radial + k[2] * (r2 + 2 * v * v) + 2 * k[3] * u * v};
}

/// cv::fisheye, Kalibr equidistant, COLMAP OPENCV_FISHEYE and its shorter kin.
inline Vector2d equidistant(const Vector3d& x, std::vector<double> k) {
  k.resize(4);
  const double r = std::hypot(x.x(), x.y()), t = std::atan2(r, x.z()), t2 = t * t;
  const double bent = t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  return {bent * x.x() / r, bent * x.y() / r};
}

/// x_in_camera = R x + t.
struct Pose {
  Matrix3d R = Matrix3d::Identity();
  Vector3d t = Vector3d::Zero();
};

/// Rotation about a fixed axis [rad], by Rodrigues' formula.
inline Matrix3d turn(const Vector3d& axis, double angle) {
  const Vector3d a = axis.normalized();
  Matrix3d cross;
  cross << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return Matrix3d::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
}

/// Some pose that no convention leaves as it is.
inline Pose some_pose() { return {turn({1, -2, 0.5}, 0.7), {0.3, -0.2, 0.9}}; }

/// 100 points that a camera sees within 25 degrees, in world coordinates.
inline std::vector<Vector3d> points_before(const Pose& pose) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> side(-0.32, 0.32), depth(2, 5);
  std::vector<Vector3d> points;
  for (int i = 0; i < 100; ++i) {
    const double z = depth(random);
    const Vector3d in_camera(side(random) * z, side(random) * z, z);
    points.push_back(pose.R.transpose() * (in_camera - pose.t));
  }
  return points;
}

inline const Camera& camera_of(const Imported& imported, const std::string& name) {
  for (const Camera& camera : imported.cameras)
    if (camera.name == name) return camera;
  throw std::out_of_range("no camera " + name);
}

/// `published`: pixel of a point in camera axes, where the centre of the first pixel is (0, 0).
inline void expect_projects(const Imported& imported, const std::string& name, const Pose& pose,
                            const std::function<Vector2d(const Vector3d&)>& published) {
  const Camera& camera = camera_of(imported, name);
  double worst = 0;
  for (const Vector3d& x : points_before(pose))
    worst = std::max(worst, (camera.project(x) - published(pose.R * x + pose.t)).norm());
  EXPECT_LT(worst, 0.01) << name;  // px
}

/// What an import says: "file:line: wrong\n  right", the folder struck out.
template <class Body>
std::string complaint(const std::filesystem::path& folder, const Body& body) {
  try {
    body();
    return "";
  } catch (const InputError& error) {
    std::string text = error.what();
    const std::string prefix = folder.string() + "/";
    for (size_t at; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
    return text;
  }
}

inline Imported import_from(const std::string& kind, const Importer::Sources& sources,
                            const ImportOptions& options = {}) {
  return import_cameras(*find_importer(kind), sources, options);
}

/// "[a, b, c]" with all digits, row by row.
template <class Derived>
std::string list(const Eigen::MatrixBase<Derived>& matrix) {
  std::string text;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      text += (text.empty() ? "[" : ", ") + fmt::format("{:.17g}", matrix(i, j));
  return text + "]";
}

}  // namespace hookeye::test
