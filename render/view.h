// One camera looking at one state of the surface: rays and projections.
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

/// All rays of a camera by h (CameraModel::ray): the ray is t (h, 1) of a central camera and (h, t)
/// where rays are parallel, in camera axes. Depends on the intrinsics alone; where lines do not
/// stay straight or pixels lean, the rays are found once and kept. NaN where a pixel has none.
class RayGrid {
 public:
  RayGrid(const Camera& camera, const PixelFilter& filter);
  bool serves(const Camera& camera, const PixelFilter& filter) const;
  /// Ray (ix, iy) of the lattice of pixel_filter.h; -margin <= ix < width n + margin.
  Vector2d h(int ix, int iy) const {
    if (!undone_.empty()) return at(undone_, ix, iy);
    return {x_[ix + margin_] + x_shift_[iy + margin_], y_[iy + margin_] + y_shift_[ix + margin_]};
  }
  /// dh/d(log focal length) of a point that stays at its pixel, negated: the surface seems to move
  /// by it (times depth).
  Vector2d zoom(int ix, int iy) const { return undone_.empty() ? h(ix, iy) : at(zoom_, ix, iy); }
  bool bent() const { return !undone_.empty(); }

 private:
  using Field = std::vector<Eigen::Vector2f>;
  Vector2d at(const Field& field, int ix, int iy) const {
    return field[static_cast<size_t>(iy + margin_) * columns_ + ix + margin_].cast<double>();
  }
  Camera camera_;
  int n_, margin_, columns_;
  Field undone_, zoom_;
  std::vector<double> x_, y_, x_shift_, y_shift_;  ///< h of a straight camera, in two parts
};

struct View {
  View(const Camera& camera, const Matrix3Xd& x, const std::vector<std::array<int, 3>>& triangles);

  Camera camera, local;            ///< local: the same camera at the origin
  bool central;                    ///< rays meet in the eye; else they are parallel
  Vector3d eye;                    ///< of a central camera [length]
  double start = 0;                ///< of parallel rays: depth where they start
  Matrix3Xd p;                     ///< vertices in camera axes
  std::vector<signed char> front;  ///< triangle turned to the camera: 1, away: -1, edge-on: 0
  int x0, y0, x1, y1;              ///< pixels [x0, x1) x [y0, y1) that the body may touch
};

}  // namespace hookeye
