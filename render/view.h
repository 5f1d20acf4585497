// One camera looking at one state of the surface: rays, projections, barycentric coordinates.
// Internal to render.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "capture_io/camera.h"
#include "render/pixel_filter.h"
#include "render/ray_scene.h"

namespace hookeye {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Directions of all rays of a camera in normalised image coordinates h: the ray is t (h, 1) with a
/// perspective camera and (h, t) with an orthographic one, in camera axes. Depends on the
/// intrinsics alone; where there is distortion they are undone once and kept.
class RayGrid {
 public:
  RayGrid(const Camera& camera, const PixelFilter& filter);
  bool serves(const Camera& camera, const PixelFilter& filter) const;
  /// Ray (ix, iy) of the lattice of pixel_filter.h; -margin <= ix < width n + margin.
  Vector2d h(int ix, int iy) const {
    if (!undone_.empty())
      return undone_[static_cast<size_t>(iy + margin_) * columns_ + ix + margin_].cast<double>();
    return {(px(ix, iy) - camera_.cx) / camera_.fx, (px(iy, ix) - camera_.cy) / camera_.fy};
  }
  /// Coordinate of ray i along one axis, `other` its index along the other [px].
  double px(int i, int other) const {
    return (i - (n_ - 1) / 2.0 + PixelFilter::shift(other, n_)) / n_;
  }

 private:
  Camera camera_;
  int n_, margin_, columns_;
  std::vector<Eigen::Vector2f> undone_;
};

struct View {
  View(const Camera& camera, const Matrix3Xd& x, const std::vector<std::array<int, 3>>& triangles);

  Camera camera, local;  ///< local: the same camera at the origin
  bool perspective, distorted;
  Vector3d eye;      ///< perspective [length]
  double start = 0;  ///< orthographic: depth where rays start
  Matrix3Xd p;       ///< vertices in camera axes
  /// Barycentric coordinates under the ray h are Q (h,1)/sum: Q inverts the corners' matrix (with
  /// an orthographic camera their third row is 1).
  std::vector<Matrix3d> Q;
  std::vector<signed char> front;  ///< triangle turned to the camera: 1, away: -1, edge-on: 0
  int x0, y0, x1, y1;              ///< pixels [x0, x1) x [y0, y1) that the body may touch

  Vector3d barycentric(int triangle, const Vector2d& h) const;
  /// Depth-like parameter of the ray at a point in camera axes.
  void set_ray(RayPacket& rays, int lane, const Vector2d& h, const Vector3d& scene_centre) const;
  /// dh/d(log focal length) of a point that stays at its pixel, negated: the surface seems to move
  /// by it (times depth).
  Vector2d zoom(const Vector2d& h) const;
};

}  // namespace hookeye
