#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "render/contour.h"

namespace hookeye {

namespace {

/// How far beside the shadow's edge its two sides are looked at. The light changes little within
/// it, and the float positions from which shadow rays start err by less.
constexpr double kStepPx = 0.02;

/// An edge that is a contour of the body as the sun sees it.
struct Caster {
  const SurfaceEdge* edge;
  int triangle;       ///< turned to the sun, or the one at a boundary
  Vector3d outwards;  ///< unit, upright on the edge and on the direction to the sun
  int pieces;
};

/// A point on a caster from which light goes on past the body.
struct CasterPoint {
  const Caster* caster;
  double s;    ///< position between the edge's ends
  Vector3d x;  ///< world axes
};

/// A point of a shadow's edge that may be visible.
struct ShadowPoint : CurvePoint {
  EdgeSegment by_caster, by_receiver;  ///< motion of the shadow's edge; the photo in the first
  double facet_size;                   ///< longest edge of the receiver [length]
};

/// Shadows of one frame.
struct ShadowEdges {
  const Frame& f;
  double strength = f.photo.sun.norm();
  Vector3d to_sun = f.photo.sun / strength;
  double margin = 10 * f.scene.epsilon();  ///< from the facet to where shadow rays start

  bool caster(const SurfaceEdge& edge, double per_length, Caster* out) const;
  void receive(const std::vector<CasterPoint>& points, std::vector<ShadowPoint>* out) const;
  bool receive(const CasterPoint& point, int receiver, ShadowPoint* out) const;
  void set_motion(const CasterPoint& point, int receiver, const Vector3d& y, double t,
                  ShadowPoint* out) const;
};

/// False where the edge casts no shadow of its own. Where two faces meet in a hollow, the edge
/// bounds the shadow of the one on the other and does not move on it.
bool ShadowEdges::caster(const SurfaceEdge& edge, double per_length, Caster* out) const {
  const Matrix3Xd& x = f.state.x;
  const auto lit = [&](int triangle) { return f.state.facets[triangle].dot(to_sun) > 0; };
  const auto apex = [&](int triangle) {
    const auto& t = f.state.surface.triangles[triangle];
    return x.col(t[0] + t[1] + t[2] - edge.a - edge.b);
  };
  int inside = edge.triangle[0], other = edge.triangle[1];
  if (other >= 0) {
    if (lit(inside) == lit(other)) return false;
    if (lit(other)) std::swap(inside, other);
    if (f.state.facets[inside].dot(apex(other) - x.col(edge.a)) >= 0) return false;
  }
  const Vector3d upright = to_sun.cross(x.col(edge.b) - x.col(edge.a));
  const double length = upright.norm();  // as the sun sees it
  if (!(length > 0)) return false;
  out->edge = &edge, out->triangle = inside;
  out->outwards = upright / length;
  if (out->outwards.dot(apex(inside) - x.col(edge.a)) > 0) out->outwards = -out->outwards;
  out->pieces = static_cast<int>(std::ceil(length * per_length));
  return true;
}

/// Follows the light past up to 16 points at a time.
void ShadowEdges::receive(const std::vector<CasterPoint>& points,
                          std::vector<ShadowPoint>* out) const {
  for (size_t begin = 0; begin < points.size(); begin += kLanes) {
    const int count = static_cast<int>(std::min<size_t>(kLanes, points.size() - begin));
    alignas(64) int active[kLanes] = {};
    RayPacket rays;
    rays.reset(0, std::numeric_limits<float>::infinity());
    for (int i = 0; i < count; ++i) {
      const CasterPoint& p = points[begin + i];
      const Vector3d beside = p.x + f.scene.epsilon() * p.caster->outwards;
      rays.set(i, beside - f.scene.centre(), -to_sun);
      active[i] = -1;
    }
    f.scene.intersect(rays, active);
    ShadowPoint q;
    for (int i = 0; i < count; ++i)
      if (rays.triangle[i] != RayPacket::kNoTriangle &&
          receive(points[begin + i], static_cast<int>(rays.triangle[i]), &q))
        out->push_back(q);
  }
}

/// With l to the sun, the receiver's normal m and the caster's point e, the shadow's point is
/// y = e - t l - margin m, whose shadow ray meets e. False where the receiver has none in sight.
bool ShadowEdges::receive(const CasterPoint& point, int receiver, ShadowPoint* out) const {
  const SurfaceEdge& edge = *point.caster->edge;
  const Vector3d& m = f.state.facets[receiver];
  const double cosine = m.dot(to_sun);
  if (receiver == edge.triangle[0] || receiver == edge.triangle[1] || cosine <= 0 ||
      f.view.front[receiver] <= 0)
    return false;
  const Matrix3Xd& x = f.state.x;
  const double t =
      (m.dot(point.x - x.col(f.state.surface.triangles[receiver][0])) - margin) / cosine;
  if (t <= 0) return false;
  const Vector3d y = point.x - t * to_sun - margin * m;
  const auto slide = [&](const Vector3d& d) { return Vector3d(d - to_sun * (m.dot(d) / cosine)); };
  const Camera& camera = f.view.camera;
  if (!place(f.view, camera.R * y + camera.t, camera.R * slide(x.col(edge.b) - x.col(edge.a)),
             -camera.R * slide(point.caster->outwards), point.caster->pieces, kStepPx, out))
    return false;
  // False for NaN.
  if (!(out->px.x() > -2 && out->px.y() > -2 && out->px.x() < camera.width + 1 &&
        out->px.y() < camera.height + 1))
    return false;
  set_motion(point, receiver, y, t, out);
  return true;
}

/// The shadow's point moves by
///   dy = P (de - t dl) + l m.dr / m.l,  P = 1 - l m^T / m.l,
/// dr: motion of the receiver's material at y.
void ShadowEdges::set_motion(const CasterPoint& point, int receiver, const Vector3d& y, double t,
                             ShadowPoint* out) const {
  const Matrix3Xd& x = f.state.x;
  const Vector3d& m = f.state.facets[receiver];
  const Vector3d by_y = f.view.camera.R.transpose() * out->n_by_point.transpose();
  const Vector3d by_receiver = m * (by_y.dot(to_sun) / m.dot(to_sun));
  const Vector3d by_caster = by_y - by_receiver;
  const auto& corner = f.state.surface.triangles[receiver];
  const Vector3d c0 = x.col(corner[0]);
  Matrix3d sides;
  sides << x.col(corner[1]) - c0, x.col(corner[2]) - c0, m;
  const Vector3d b = sides.inverse() * (y - c0);
  out->by_receiver = out->by_caster = EdgeSegment();
  out->by_receiver.triangle = receiver;
  out->by_receiver.d_position = by_receiver * Eigen::RowVector3d(1 - b[0] - b[1], b[0], b[1]);
  const SurfaceEdge& edge = *point.caster->edge;
  const auto& from = f.state.surface.triangles[point.caster->triangle];
  out->by_caster.triangle = point.caster->triangle;
  out->facet_size = 0;
  for (int k = 0; k < 3; ++k) {
    if (from[k] == edge.a) out->by_caster.d_position.col(k) = (1 - point.s) * by_caster;
    if (from[k] == edge.b) out->by_caster.d_position.col(k) = point.s * by_caster;
    const Vector3d side = x.col(corner[k]) - x.col(corner[(k + 1) % 3]);
    out->facet_size = std::max(out->facet_size, side.norm());
  }
  out->by_caster.d_photo.head<7>() = out->n_by_camera.transpose();
  out->by_caster.d_photo.segment<3>(kSun) = -t / strength * by_caster;
}

/// Whether lanes i and i+1 see the receiver, dark inside and lit outside.
bool sees_edge(const ShadowPoint& q, const Samples& s, int i) {
  for (int k : {i, i + 1})
    if (s.triangle[k] < 0 || std::abs(s.depth[k] - q.depth) > q.facet_size) return false;
  return !s.lit[i] && s.lit[i + 1];
}

/// Pixels a length takes in the middle of the body [px/length].
double picture_scale(const Frame& f) {
  if (!f.view.central) return f.view.camera.fx;
  const Camera& camera = f.view.local;
  const Vector3d middle = f.view.camera.R * f.scene.centre() + f.view.camera.t;
  const double unit = camera.model->unit_at(camera.distortion, middle);
  // where the body lies about the eye, its middle says little
  return camera.fx / std::max(unit, f.view.p.row(2).maxCoeff() / 2);
}

}  // namespace

void shadow_segments(const Frame& f, const PixelFilter& filter,
                     const std::vector<SurfaceEdge>& edges, size_t first, size_t last,
                     std::vector<EdgeSegment>* out) {
  if (!f.options.cast_shadows || !f.photo.shaded || f.photo.sun.isZero(0.0)) return;
  const ShadowEdges shadows{f};
  const double per_length = std::max(4, 2 * filter.n) * picture_scale(f);
  if (!(per_length > 0)) return;  // the body lies behind the camera
  std::vector<Caster> casters;
  Caster caster;
  for (size_t e = first; e < last; ++e)
    if (shadows.caster(edges[e], per_length, &caster)) casters.push_back(caster);
  std::vector<CasterPoint> from;
  for (const Caster& c : casters)
    for (int i = 0; i < c.pieces; ++i) {
      const double s = (i + 0.5) / c.pieces;
      from.push_back({&c, s, (1 - s) * f.state.x.col(c.edge->a) + s * f.state.x.col(c.edge->b)});
    }
  std::vector<ShadowPoint> points;
  shadows.receive(from, &points);
  look_beside(f, points, [&](const ShadowPoint& q, const Samples& s, const Shading& seen, int i) {
    if (!sees_edge(q, s, i)) return;
    const Jump jump = {double(seen.I[i]) - seen.I[i + 1], 0};
    for (const EdgeSegment* motion : {&q.by_caster, &q.by_receiver})
      spread(f, filter, q, jump, *motion, kLongBack, out);
  });
}

}  // namespace hookeye
