#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "render/frame.h"

namespace hookeye {

namespace {

/// Whether triangles f and g find vertex a or b at different places of the texture.
bool is_seam(const SurfaceMesh& surface, int f, int g, int a, int b) {
  constexpr double kSame = 1e-6;  // rounding where a surface was cut
  const auto at = [&](int triangle, int vertex) {
    const auto& t = surface.triangles[triangle];
    return surface.uv[triangle][std::find(t.begin(), t.end(), vertex) - t.begin()];
  };
  return (at(f, a) - at(g, a)).norm() > kSame || (at(f, b) - at(g, b)).norm() > kSame;
}

}  // namespace

std::vector<SurfaceEdge> surface_edges(const SurfaceMesh& surface) {
  std::map<std::pair<int, int>, std::vector<int>> at;
  for (size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& t = surface.triangles[f];
    for (int k = 0; k < 3; ++k)
      at[std::minmax(t[k], t[(k + 1) % 3])].push_back(static_cast<int>(f));
  }
  std::vector<SurfaceEdge> out;
  for (const auto& [edge, faces] : at) {
    const auto [a, b] = edge;
    const int f = faces[0], g = faces.size() > 1 ? faces[1] : -1;
    out.push_back({a, b, {f, g}, g >= 0 && !surface.uv.empty() && is_seam(surface, f, g, a, b)});
  }
  return out;
}

namespace {

/// How far beside an edge its two sides are looked at. Light from behind the camera falls with the
/// root of the distance to a rim. What it falls within the step the interior term has counted
/// already: at 0.02 px that made 4 to 15 % of a derivative (Contours.lit).
constexpr double kStepPx = 0.002;
/// Of the distance to the camera: what a ray of floats must be off an edge to be beside it.
constexpr double kRayError = 1e-6;

/// A point that may be visible on an edge at which the intensity may jump.
struct EdgePoint {
  int inside;   ///< triangle
  int outside;  ///< the other triangle where it is seen too; else -1
  int a, b;
  double s;                                ///< position between the edge's ends
  double length_px;                        ///< of the edge that this point stands for
  Vector2d px, normal;                     ///< in the picture; normal away from the triangle
  double depth;                            ///< as Sample::depth
  double facet_size;                       ///< longest edge of the triangle [length]
  Vector2d h;                              ///< ray through the point
  Vector2d step_h;                         ///< change of h for a step beside it, along the normal
  Eigen::Matrix<double, 1, 3> n_by_point;  ///< normal motion [px] by camera-space position
  Eigen::Matrix<double, 1, 7> n_by_camera;
};

/// Whether the intensity may jump from one of the edge's triangles to the other where both are
/// seen.
bool jumps_between(const Frame& f, const SurfaceEdge& edge) {
  constexpr double kCoplanar = 1e-6;  // [rad]
  if (edge.seam && f.texture.source == Texture::Source::image) return true;
  const auto& facets = f.state.facets;
  return f.photo.shaded && !f.options.smooth_normals &&
         (facets[edge.triangle[0]] - facets[edge.triangle[1]]).norm() > kCoplanar;
}

/// The triangle turned to the camera where exactly one is, or the one at a boundary; either of two
/// that differ in intensity; else -1.
int contour_triangle(const Frame& frame, const SurfaceEdge& edge) {
  const int f = edge.triangle[0], g = edge.triangle[1];
  if (g < 0) return f;
  const bool a = frame.view.front[f] > 0, b = frame.view.front[g] > 0;
  if (a && b) return jumps_between(frame, edge) ? f : -1;
  return a == b ? -1 : (a ? f : g);
}

/// Points along the projected edge, `per_px` a pixel.
void add_points(const Frame& f, const SurfaceEdge& edge, int inside, double per_px,
                std::vector<EdgePoint>* out) {
  const View& view = f.view;
  const Vector3d pa = view.p.col(edge.a), pb = view.p.col(edge.b);
  const Vector2d ua = view.local.project(pa), ub = view.local.project(pb);
  const double length = (ub - ua).norm();
  if (!std::isfinite(length) || length <= 0) return;
  const Vector2d low = ua.cwiseMin(ub), high = ua.cwiseMax(ub);
  if (high.x() < -2 || high.y() < -2 || low.x() > view.camera.width + 1 ||
      low.y() > view.camera.height + 1)
    return;
  const auto& t = f.state.surface.triangles[inside];
  const int other = edge.triangle[edge.triangle[0] == inside];
  const int outside = other >= 0 && view.front[other] > 0 ? other : -1;
  const int apex = t[0] + t[1] + t[2] - edge.a - edge.b;
  const int count = static_cast<int>(std::ceil(length * per_px));
  double size = 0;
  for (int k = 0; k < 3; ++k)
    size = std::max(size, (view.p.col(t[k]) - view.p.col(t[(k + 1) % 3])).norm());
  for (int i = 0; i < count; ++i) {
    EdgePoint q;
    q.inside = inside, q.outside = outside, q.a = edge.a, q.b = edge.b;
    q.facet_size = size;
    q.s = (i + 0.5) / count;
    const Vector3d p = (1 - q.s) * pa + q.s * pb;
    Camera::Jacobian3 by_point;
    Camera::Jacobian7 by_camera;
    q.px = view.local.project(p, &by_point, &by_camera);
    const Vector2d along = by_point * (pb - pa);
    q.length_px = along.norm() / count;
    if (q.length_px <= 0) continue;
    q.normal = Vector2d(along.y(), -along.x()).normalized();
    if (q.normal.dot(by_point * (view.p.col(apex) - p)) > 0) q.normal = -q.normal;
    q.n_by_point = q.normal.transpose() * by_point;
    q.n_by_camera = q.normal.transpose() * by_camera;
    q.h = view.perspective ? Vector2d(p.head<2>() / p.z()) : Vector2d(p.head<2>());
    q.depth = view.perspective ? p.z() : p.z() - view.start;
    const double scale = view.perspective ? p.z() : 1.0;
    const Eigen::Matrix2d px_by_h = scale * by_point.leftCols<2>();
    const double step_px = std::max(kStepPx, kRayError * p.norm() * by_point.leftCols<2>().norm());
    q.step_h = px_by_h.inverse() * q.normal * step_px;
    out->push_back(q);
  }
}

/// The body's intensity and the share of what is behind it.
struct Side {
  double I, behind;
  Side operator-(const Side& other) const { return {I - other.I, behind - other.behind}; }
};

/// What lane i sees; NaN where that lies in front of the edge.
Side beside(const EdgePoint& q, const Samples& s, const Shading& shading, int i) {
  if (s.triangle[i] < 0) return {0.0, 1.0};
  // Beside a contour the surface is seen edge-on: within a facet's size nothing counts as in front
  // (and what lies there hides both sides alike, so that the contrast vanishes anyhow).
  return {s.depth[i] < q.depth - q.facet_size ? std::nan("") : shading.I[i], 0.0};
}

/// Whether lanes i and i+1 see the two triangles at an edge of which both are seen. What is hidden
/// makes no jump, nor does a facet narrower than the step: the contour behind it has its share.
bool sees_both(const EdgePoint& q, const Samples& s, int i) {
  return q.outside < 0 || (s.triangle[i] == q.inside && s.triangle[i + 1] == q.outside);
}

/// Adds to all pixels whose filter reaches the point. The filter is what the fixed rays amount to
/// in the mean over their position: the weight of a ray over its cell of 1/n px.
void spread(const Frame& f, const PixelFilter& filter, const EdgePoint& q, const Side& jump,
            std::vector<EdgeSegment>* out) {
  const int n = filter.n, taps = filter.taps();
  const double at_x = q.px.x() * n + (n - 1) / 2.0, at_y = q.px.y() * n + (n - 1) / 2.0;
  const auto nearest = [&](double at, double other) {
    return static_cast<int>(
        std::lround(at - PixelFilter::shift(static_cast<int>(std::lround(other)), n)));
  };
  const int ix = nearest(at_x, at_y) + filter.margin, iy = nearest(at_y, at_x) + filter.margin;
  const auto floor_div = [](int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); };
  EdgeSegment segment;
  segment.triangle = q.inside;
  const auto& t = f.state.surface.triangles[q.inside];
  const Vector3d by_point = f.view.camera.R.transpose() * q.n_by_point.transpose();
  segment.d_position.setZero();
  for (int k = 0; k < 3; ++k) {
    if (t[k] == q.a) segment.d_position.col(k) = (1 - q.s) * by_point;
    if (t[k] == q.b) segment.d_position.col(k) = q.s * by_point;
  }
  segment.d_camera = q.n_by_camera.transpose();
  for (int y = floor_div(iy - taps, n) + 1; y <= floor_div(iy, n); ++y)
    for (int x = floor_div(ix - taps, n) + 1; x <= floor_div(ix, n); ++x) {
      if (x < 0 || y < 0 || x >= f.view.camera.width || y >= f.view.camera.height) continue;
      const int pixel = y * f.view.camera.width + x;
      const double contrast = jump.I + jump.behind * f.photo.behind(pixel);
      const double w = contrast * q.length_px * filter.weight(ix - x * n, iy - y * n) * n * n;
      // Neighbouring points of one edge mostly meet the same pixel.
      EdgeSegment* same = nullptr;
      for (size_t back = 1; back <= 4 && back <= out->size(); ++back) {
        EdgeSegment& e = (*out)[out->size() - back];
        if (e.pixel == pixel && e.triangle == q.inside) same = &e;
      }
      if (!same) {
        out->push_back({pixel, q.inside, Matrix3d::Zero(), Eigen::Matrix<double, 7, 1>::Zero()});
        same = &out->back();
      }
      same->d_position += w * segment.d_position;
      same->d_camera += w * segment.d_camera;
    }
}

}  // namespace

void silhouette_segments(const Frame& f, const PixelFilter& filter,
                         const std::vector<SurfaceEdge>& edges, size_t first, size_t last,
                         std::vector<EdgeSegment>* out) {
  std::vector<EdgePoint> points;
  const double per_px = std::max(4, 2 * filter.n);
  for (size_t e = first; e < last; ++e) {
    const int inside = contour_triangle(f, edges[e]);
    if (inside >= 0) add_points(f, edges[e], inside, per_px, &points);
  }
  for (size_t begin = 0; begin < points.size(); begin += 8) {
    const int count = static_cast<int>(std::min<size_t>(8, points.size() - begin));
    Vector2d h[kLanes];
    Samples samples;
    Shading shading;
    for (int i = 0; i < count; ++i) {
      h[2 * i] = points[begin + i].h - points[begin + i].step_h;
      h[2 * i + 1] = points[begin + i].h + points[begin + i].step_h;
    }
    trace(f, h, 2 * count, &samples);
    shade(f, samples, false, &shading);
    for (int i = 0; i < count; ++i) {
      const EdgePoint& q = points[begin + i];
      if (!sees_both(q, samples, 2 * i)) continue;
      const Side jump = beside(q, samples, shading, 2 * i) - beside(q, samples, shading, 2 * i + 1);
      if ((jump.I != 0 || jump.behind != 0) && !std::isnan(jump.I)) spread(f, filter, q, jump, out);
    }
  }
}

}  // namespace hookeye
