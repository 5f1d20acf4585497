#include "render/contour.h"

#include <Eigen/LU>
#include <cmath>

namespace hookeye {

namespace {

/// Of the distance to the camera: what a ray of floats must be off an edge to be beside it.
constexpr double kRayError = 1e-6;

}  // namespace

bool place(const View& view, const Vector3d& p, const Vector3d& along, const Vector3d& inwards,
           int pieces, double step_px, CurvePoint* out) {
  CurvePoint& q = *out;
  Camera::Jacobian3 by_point;
  Camera::Jacobian7 by_camera;
  q.px = view.local.project(p, &by_point, &by_camera);
  const Vector2d along_px = by_point * along;
  q.length_px = along_px.norm() / pieces;
  if (q.length_px <= 0) return false;
  q.normal = Vector2d(along_px.y(), -along_px.x()).normalized();
  if (q.normal.dot(by_point * inwards) > 0) q.normal = -q.normal;
  q.n_by_point = q.normal.transpose() * by_point;
  q.n_by_camera = q.normal.transpose() * by_camera;
  q.h = view.central ? Vector2d(p.head<2>() / p.z()) : Vector2d(p.head<2>());
  q.depth = view.central ? p.z() : p.z() - view.start;
  const double scale = view.central ? p.z() : 1.0;
  const Eigen::Matrix2d px_by_h = scale * by_point.leftCols<2>();
  const double step = std::max(step_px, kRayError * p.norm() * by_point.leftCols<2>().norm());
  q.step_h = px_by_h.inverse() * q.normal * step;
  return true;
}

/// The filter is what the fixed rays amount to in the mean over their position: the weight of a ray
/// over its cell of 1/n px.
void spread(const Frame& f, const PixelFilter& filter, const CurvePoint& q, const Jump& jump,
            const EdgeSegment& motion, size_t back, std::vector<EdgeSegment>* out) {
  const int n = filter.n, taps = filter.taps();
  const double at_x = q.px.x() * n + (n - 1) / 2.0, at_y = q.px.y() * n + (n - 1) / 2.0;
  const auto nearest = [&](double at, double other) {
    return static_cast<int>(
        std::lround(at - PixelFilter::shift(static_cast<int>(std::lround(other)), n)));
  };
  const int ix = nearest(at_x, at_y) + filter.margin, iy = nearest(at_y, at_x) + filter.margin;
  const auto floor_div = [](int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); };
  for (int y = floor_div(iy - taps, n) + 1; y <= floor_div(iy, n); ++y)
    for (int x = floor_div(ix - taps, n) + 1; x <= floor_div(ix, n); ++x) {
      if (x < 0 || y < 0 || x >= f.view.camera.width || y >= f.view.camera.height) continue;
      const int pixel = y * f.view.camera.width + x;
      const double contrast = jump.I + jump.behind * f.photo.behind(pixel);
      const double w = contrast * q.length_px * filter.weight(ix - x * n, iy - y * n) * n * n;
      EdgeSegment* same = nullptr;
      for (size_t k = 1; k <= std::min(back, out->size()) && !same; ++k) {
        EdgeSegment& e = (*out)[out->size() - k];
        if (e.pixel == pixel && e.triangle == motion.triangle) same = &e;
      }
      if (!same) {
        same = &out->emplace_back();
        same->pixel = pixel, same->triangle = motion.triangle;
      }
      same->d_position += w * motion.d_position;
      same->d_photo += w * motion.d_photo;
    }
}

}  // namespace hookeye
