#include <cmath>
#include <limits>
#include <numbers>

#include "render/frame.h"

namespace hookeye {

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

Vector3d interpolate(const Matrix3Xd& at, const std::array<int, 3>& t, const Vector3d& bary) {
  return bary[0] * at.col(t[0]) + bary[1] * at.col(t[1]) + bary[2] * at.col(t[2]);
}

void set_lane(RayPacket& rays, int lane, const Vector3d& from, const Vector3d& direction) {
  rays.org_x[lane] = float(from.x());
  rays.org_y[lane] = float(from.y());
  rays.org_z[lane] = float(from.z());
  rays.dir_x[lane] = float(direction.x());
  rays.dir_y[lane] = float(direction.y());
  rays.dir_z[lane] = float(direction.z());
}

/// Where the shadow ray of a point of the faceted surface starts. Interpolated normals belong to a
/// curved surface; near the terminator the point is lifted onto it (Hanika 2021, Hacking the shadow
/// terminator), fully where the facet turns away from the sun, not at all above 0.1 of cosine.
Vector3d shadow_origin(const Frame& f, const Sample& s, const Vector3d& facet,
                       const Vector3d& sun) {
  const auto& t = f.surface.triangles[s.triangle];
  const Vector3d point = interpolate(f.x, t, s.bary);
  const double cosine = facet.dot(sun), margin = 10 * f.scene.epsilon();
  const double amount = f.options.smooth_normals ? std::clamp(1 - cosine / 0.1, 0.0, 1.0) : 0.0;
  if (amount == 0) return point + margin * facet;
  Vector3d lift = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vector3d n = f.normals.col(t[k]);
    lift -= s.bary[k] * std::min(0.0, n.dot(point - f.x.col(t[k]))) * n;
  }
  return point + amount * lift + margin * interpolate(f.normals, t, s.bary).normalized();
}

void cast_shadows(const Frame& f, int count, Sample* samples) {
  const double strength = f.photo.sun.norm();
  if (!f.photo.shaded || strength <= 0) return;
  const Vector3d sun = f.photo.sun / strength;
  alignas(64) int active[16] = {};
  RayPacket rays;
  bool any = false;
  for (int i = 0; i < count; ++i) {
    Sample& s = samples[i];
    if (s.triangle < 0) continue;
    const auto& t = f.surface.triangles[s.triangle];
    const Vector3d& facet = f.facets[s.triangle];
    s.lit = (f.options.smooth_normals ? interpolate(f.normals, t, s.bary) : facet).dot(sun) > 0;
    if (!s.lit || !f.options.cast_shadows) continue;
    if (!any) rays.reset(0, kFar);
    any = true;
    active[i] = -1;
    set_lane(rays, i, shadow_origin(f, s, facet, sun) - f.scene.centre(), sun);
  }
  if (!any) return;
  f.scene.occluded(rays, active);
  for (int i = 0; i < count; ++i)
    if (active[i]) samples[i].lit = rays.tfar[i] >= 0;
}

/// Points that the reference camera does not see have no colour: taken out of the picture.
void drop_unseen(const Frame& f, int count, Sample* samples) {
  const View& view = *f.reference_view;
  const Image& photo = *f.texture.photo;
  const auto* valid = f.texture.photo_valid.get();
  alignas(64) int active[16] = {};
  RayPacket rays;
  rays.reset(0, 1);
  bool any = false;
  for (int i = 0; i < count; ++i) {
    Sample& s = samples[i];
    if (s.triangle < 0) continue;
    const auto& t = f.surface.triangles[s.triangle];
    const Vector3d p = interpolate(view.p, t, s.bary);
    const Vector2d px = view.local.project(p);
    const bool inside = px.x() >= 0 && px.y() >= 0 && px.x() <= photo.width - 1 &&
                        px.y() <= photo.height - 1;  // false for NaN
    if (!inside || view.front[s.triangle] <= 0 ||
        (valid &&
         !(*valid)[static_cast<size_t>(std::lround(px.y())) * photo.width + std::lround(px.x())])) {
      s.triangle = -1;
      continue;
    }
    const RayScene& scene = *f.reference_scene;
    const Vector3d from = interpolate(*f.x_reference, t, s.bary) - scene.centre();
    const Vector3d back = -view.camera.R.row(2).transpose();
    const Vector3d to = view.perspective ? Vector3d(view.eye - scene.centre())
                                         : Vector3d(from + (p.z() - view.start) * back);
    const double length = (to - from).norm();
    set_lane(rays, i, from, to - from);
    rays.tnear[i] = float(10 * scene.epsilon() / length);
    active[i] = -1;
    any = true;
  }
  if (!any) return;
  f.reference_scene->occluded(rays, active);
  for (int i = 0; i < count; ++i)
    if (active[i] && rays.tfar[i] < 0) samples[i].triangle = -1;
}

}  // namespace

void trace(const Frame& f, const Vector2d* h, int count, Sample* out) {
  alignas(64) int active[16] = {};
  RayPacket rays;
  rays.reset(0, kFar);
  for (int i = 0; i < count; ++i) {
    active[i] = -1;
    f.view.set_ray(rays, i, h[i], f.scene.centre());
  }
  f.scene.intersect(rays, active);
  bool any = false;
  for (int i = 0; i < count; ++i) {
    out[i].h = h[i];
    out[i].lit = false;
    out[i].depth = rays.tfar[i];
    out[i].triangle =
        rays.triangle[i] == RayPacket::kNoTriangle ? -1 : static_cast<int>(rays.triangle[i]);
    if (out[i].triangle < 0) continue;
    any = true;
    out[i].bary = f.view.barycentric(out[i].triangle, h[i]);
  }
  if (!any) return;
  if (f.reference_scene) drop_unseen(f, count, out);
  cast_shadows(f, count, out);
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

}  // namespace

std::vector<double> sky_visibility(const RayScene& scene, const Matrix3Xd& x,
                                   const Matrix3Xd& normals, int rays) {
  std::vector<double> out(x.cols(), 1.0);
  if (rays <= 0) return out;
  const std::vector<Vector3d> directions = cosine_directions(rays);
  for (int v = 0; v < x.cols(); ++v) {
    const Vector3d n = normals.col(v);
    // Frame of Duff et al. 2017, Building an orthonormal basis, revisited.
    const double sign = n.z() < 0 ? -1 : 1, a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
    const Vector3d e1(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
    const Vector3d e2(b, sign + n.y() * n.y() * a, -n.y());
    const Vector3d from = x.col(v) - scene.centre() + 10 * scene.epsilon() * n;
    int open = 0;
    for (int first = 0; first < rays; first += 16) {
      alignas(64) int active[16] = {};
      RayPacket packet;
      packet.reset(0, kFar);
      const int count = std::min(16, rays - first);
      for (int i = 0; i < count; ++i) {
        const Vector3d& d = directions[first + i];
        set_lane(packet, i, from, d.x() * e1 + d.y() * e2 + d.z() * n);
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
