#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "render/frame.h"
#include "render/hits.h"

namespace hookeye {

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Central: from the eye along R^T (h,1). Parallel: from R^T ((h,start) - t) along R^T z.
void set_rays(const Frame& f, const Samples& s, RayPacket* rays) {
  const View& view = f.view;
  const Eigen::Matrix3f Rt = view.camera.R.transpose().cast<float>();
  const Vector3d start = view.camera.R.transpose() * (Vector3d(0, 0, view.start) - view.camera.t);
  const Eigen::Vector3f from = ((view.central ? view.eye : start) - f.scene.centre()).cast<float>();
  float* origin[3] = {rays->org_x, rays->org_y, rays->org_z};
  float* direction[3] = {rays->dir_x, rays->dir_y, rays->dir_z};
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < kLanes; ++i) {
      const float across = Rt(c, 0) * s.h[0][i] + Rt(c, 1) * s.h[1][i];
      origin[c][i] = view.central ? from[c] : from[c] + across;
      direction[c][i] = view.central ? across + Rt(c, 2) : Rt(c, 2);
    }
}

void cast_shadows(const Frame& f, Samples* s) {
  const double strength = f.photo.sun.norm();
  if (!f.photo.shaded || strength <= 0) return;
  RayPacket rays;
  rays.reset(0, kFar);
  shadow_rays(f, s, &rays);
  if (!f.options.cast_shadows) return;
  bool any = false;
  for (int i = 0; i < s->count; ++i) any |= s->lit[i] != 0;
  if (!any) return;
  f.scene.occluded(rays, s->lit);
  for (int i = 0; i < s->count; ++i)
    if (rays.tfar[i] < 0) s->lit[i] = 0;
}

/// Points that the reference camera does not see have no colour: taken out of the picture.
void drop_unseen(const Frame& f, Samples* s) {
  const View& view = *f.reference_view;
  const Image& photo = *f.texture.photo;
  const auto* valid = f.texture.photo_valid.get();
  alignas(64) int active[kLanes] = {};
  RayPacket rays;
  rays.reset(0, 1);
  bool any = false;
  for (int i = 0; i < s->count; ++i) {
    if (s->triangle[i] < 0) continue;
    const auto& t = f.state.surface.triangles[s->triangle[i]];
    const Vector3d p = interpolate(view.p, t, *s, i);
    const Vector2d px = view.local.project(p);
    const bool inside = px.x() >= 0 && px.y() >= 0 && px.x() <= photo.width - 1 &&
                        px.y() <= photo.height - 1;  // false for NaN
    if (!inside || view.front[s->triangle[i]] <= 0 ||
        (valid &&
         !(*valid)[static_cast<size_t>(std::lround(px.y())) * photo.width + std::lround(px.x())])) {
      s->triangle[i] = -1;
      continue;
    }
    const RayScene& scene = *f.reference_scene;
    const Vector3d from = interpolate(*f.x_reference, t, *s, i) - scene.centre();
    const Vector3d back = -view.camera.R.row(2).transpose();
    const Vector3d to = view.central ? Vector3d(view.eye - scene.centre())
                                     : Vector3d(from + (p.z() - view.start) * back);
    const double length = (to - from).norm();
    rays.set(i, from, to - from);
    rays.tnear[i] = float(10 * scene.epsilon() / length);
    active[i] = -1;
    any = true;
  }
  if (!any) return;
  f.reference_scene->occluded(rays, active);
  for (int i = 0; i < s->count; ++i)
    if (active[i] && rays.tfar[i] < 0) s->triangle[i] = -1;
}

}  // namespace

void trace(const Frame& f, const Vector2d* h, int count, Samples* s) {
  alignas(64) int active[kLanes];
  RayPacket rays;
  rays.reset(0, kFar);
  s->count = count;
  for (int i = 0; i < kLanes; ++i) {
    active[i] = i < count && h[i].allFinite() ? -1 : 0;
    for (int c = 0; c < 2; ++c)
      s->h[c][i] = s->zoom[c][i] = static_cast<float>(h[std::min(i, count - 1)][c]);
  }
  set_rays(f, *s, &rays);
  f.scene.intersect(rays, active);
  bool any = false;
  for (int i = 0; i < kLanes; ++i) {
    s->lit[i] = 0;
    s->depth[i] = rays.tfar[i];
    s->triangle[i] = i >= count || rays.triangle[i] == RayPacket::kNoTriangle
                         ? -1
                         : static_cast<int>(rays.triangle[i]);
    any |= s->triangle[i] >= 0;
  }
  if (!any) return;
  meet_triangles(f, h, s);
  if (f.reference_scene) drop_unseen(f, s);
  cast_shadows(f, s);
}

namespace {

/// Base-2 radical inverse (van der Corput).
double radical_inverse(unsigned i) {
  double r = 0, digit = 0.5;
  for (; i; i >>= 1, digit /= 2)
    if (i & 1) r += digit;
  return r;
}

/// Hammersley points mapped to cosine-weighted directions about z (Malley).
std::vector<Vector3d> cosine_directions(int rays) {
  std::vector<Vector3d> out(rays);
  for (int i = 0; i < rays; ++i) {
    const double r = std::sqrt((i + 0.5) / rays), a = 2 * std::numbers::pi * radical_inverse(i);
    out[i] = {r * std::cos(a), r * std::sin(a), std::sqrt(std::max(0.0, 1 - r * r))};
  }
  return out;
}

/// Two axes across the normal n; the first one on the side of `outwards`, as seen from the surface,
/// so that the few rays of a vertex turn with the body.
std::pair<Vector3d, Vector3d> tangents(const Vector3d& n, const Vector3d& outwards) {
  const Vector3d across = outwards - outwards.dot(n) * n;
  if (across.norm() > 0.01 * outwards.norm()) {
    const Vector3d e1 = across.normalized();
    return {e1, n.cross(e1)};
  }
  // Of a place that looks straight outwards: frame of Duff et al. 2017, Building an orthonormal
  // basis, revisited.
  const double sign = n.z() < 0 ? -1 : 1, a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  return {Vector3d(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Vector3d(b, sign + n.y() * n.y() * a, -n.y())};
}

}  // namespace

std::vector<double> sky_visibility(const RayScene& scene, const Matrix3Xd& x,
                                   const Matrix3Xd& normals, int rays) {
  std::vector<double> out(x.cols(), 1.0);
  if (rays <= 0) return out;
  const std::vector<Vector3d> directions = cosine_directions(rays);
  const Vector3d middle = x.rowwise().mean();
  for (int v = 0; v < x.cols(); ++v) {
    const Vector3d n = normals.col(v);
    const auto [e1, e2] = tangents(n, x.col(v) - middle);
    const Vector3d from = x.col(v) - scene.centre() + 10 * scene.epsilon() * n;
    int open = 0;
    for (int first = 0; first < rays; first += 16) {
      alignas(64) int active[16] = {};
      RayPacket packet;
      packet.reset(0, kFar);
      const int count = std::min(16, rays - first);
      for (int i = 0; i < count; ++i) {
        const Vector3d& d = directions[first + i];
        packet.set(i, from, d.x() * e1 + d.y() * e2 + d.z() * n);
        active[i] = -1;
      }
      scene.occluded(packet, active, false);
      for (int i = 0; i < count; ++i) open += packet.tfar[i] >= 0;
    }
    out[v] = double(open) / rays;
  }
  return out;
}

}  // namespace hookeye
