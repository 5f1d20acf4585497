#include <algorithm>
#include <cmath>
#include <map>

#include "render/contour.h"

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

/// A point that may be visible on an edge at which the intensity may jump.
struct EdgePoint : CurvePoint {
  int inside;   ///< triangle
  int outside;  ///< the other triangle where it is seen too; else -1
  int a, b;
  double s;           ///< position between the edge's ends
  double facet_size;  ///< longest edge of the triangle [length]
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

/// Points along the projected edge, `per_px` a pixel; half as many between triangles that are both
/// seen, since there are many such edges and their jumps are small.
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
  const int count = static_cast<int>(std::ceil(length * (outside < 0 ? per_px : per_px / 2)));
  double size = 0;
  for (int k = 0; k < 3; ++k)
    size = std::max(size, (view.p.col(t[k]) - view.p.col(t[(k + 1) % 3])).norm());
  for (int i = 0; i < count; ++i) {
    EdgePoint q;
    q.inside = inside, q.outside = outside, q.a = edge.a, q.b = edge.b;
    q.facet_size = size;
    q.s = (i + 0.5) / count;
    const Vector3d p = (1 - q.s) * pa + q.s * pb;
    if (place(view, p, pb - pa, view.p.col(apex) - p, count, kStepPx, &q)) out->push_back(q);
  }
}

/// What lane i sees, as a jump from nothing; NaN where that lies in front of the edge.
Jump beside(const EdgePoint& q, const Samples& s, const Shading& shading, int i) {
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

EdgeSegment motion_of(const Frame& f, const EdgePoint& q) {
  EdgeSegment out;
  out.triangle = q.inside;
  const auto& t = f.state.surface.triangles[q.inside];
  const Vector3d by_point = f.view.camera.R.transpose() * q.n_by_point.transpose();
  for (int k = 0; k < 3; ++k) {
    if (t[k] == q.a) out.d_position.col(k) = (1 - q.s) * by_point;
    if (t[k] == q.b) out.d_position.col(k) = q.s * by_point;
  }
  out.d_photo.head<7>() = q.n_by_camera.transpose();
  return out;
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
  look_beside(f, points, [&](const EdgePoint& q, const Samples& s, const Shading& shading, int i) {
    if (!sees_both(q, s, i)) return;
    const Jump inside = beside(q, s, shading, i), outside = beside(q, s, shading, i + 1);
    const Jump jump = {inside.I - outside.I, inside.behind - outside.behind};
    if ((jump.I != 0 || jump.behind != 0) && !std::isnan(jump.I))
      spread(f, filter, q, jump, motion_of(f, q), q.outside < 0 ? kShortBack : kLongBack, out);
  });
}

}  // namespace hookeye
