// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/hits.cpp"
#include "render/hits.h"

#include <hwy/foreach_target.h>

#include <algorithm>

#include "render/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace hookeye::HWY_NAMESPACE {

void triangle_lanes(const Frame& f, const Vector2d* h, Samples* s) {
  const float* row[kLanes];
  int some = 0;
  for (int i = 0; i < s->count; ++i)
    if (s->triangle[i] >= 0) some = s->triangle[i];
  bool one = true;
  for (int i = 0; i < kLanes; ++i) {
    const int triangle = s->triangle[i] >= 0 ? s->triangle[i] : some;
    const TriangleTable::Row& at = f.table.rows[triangle];
    row[i] = at.value.data();
    one &= triangle == some;
    const Vector2d& ray = h[std::min(i, s->count - 1)];
    for (int c = 0; c < 2; ++c) {
      s->dh[c][i] = static_cast<float>(ray[c] - at.h0[c]);
      s->texel[c][i] = at.texel[c];
    }
  }
  if (!one) return to_lanes(row, kTriangleFloats, s->of_triangle);
  for (int k = 0; k < kTriangleFloats; ++k)
    for (size_t at = 0; at < kLanes; at += hn::Lanes(Tag()))
      store(set(row[0][k]), s->of_triangle[k] + at);
}

void barycentric_lanes(Samples* s) {
  for (size_t at = 0; at < kLanes; at += hn::Lanes(Tag())) {
    const V dx = load(s->dh[0] + at), dy = load(s->dh[1] + at);
    const V3 third = {set(1 / 3.0f), set(1 / 3.0f), set(1 / 3.0f)};
    V3 b = third + dx * load3(s->of_triangle + kRayToBary, at) +
           dy * load3(s->of_triangle + kRayToBary + 3, at);
    // Embree decides in its own rounding which triangle is hit; stay on it.
    b = {hn::Max(b.x, set(0)), hn::Max(b.y, set(0)), hn::Max(b.z, set(0))};
    const V inverse = set(1) / (b.x + b.y + b.z);
    b = inverse * b;
    store(b.x, s->bary[0] + at);
    store(b.y, s->bary[1] + at);
    store(b.z, s->bary[2] + at);
  }
}

/// Where the shadow ray of a point of the faceted surface starts. Interpolated normals belong to a
/// curved surface; near the terminator the point is lifted onto it (Hanika 2021, Hacking the shadow
/// terminator), fully where the facet turns away from the sun, not at all above 0.1 of cosine.
V3 shadow_origin(const Frame& f, const Samples& s, const V* b, V3 normal, V3 sun, size_t at) {
  const V3 facet = load3(s.of_triangle + kFacet, at);
  const V3 point = interpolate(b, s.of_triangle + kCorners, at);
  const V margin = set(static_cast<float>(10 * f.scene.epsilon()));
  const V3 beside = point + margin * facet;
  if (!f.options.smooth_normals) return beside;
  const V amount = hn::Min(hn::Max(set(1) - dot(facet, sun) / set(0.1f), set(0)), set(1));
  V3 lift = {set(0), set(0), set(0)};
  for (int k = 0; k < 3; ++k) {
    const V3 n = load3(s.of_triangle + kNormals + 3 * k, at);
    const V3 corner = load3(s.of_triangle + kCorners + 3 * k, at);
    lift = lift - (b[k] * hn::Min(set(0), dot(n, point - corner))) * n;
  }
  const V3 lifted = point + amount * lift + (margin * inverse_norm(normal)) * normal;
  const Mask flat = amount == set(0);
  return {hn::IfThenElse(flat, beside.x, lifted.x), hn::IfThenElse(flat, beside.y, lifted.y),
          hn::IfThenElse(flat, beside.z, lifted.z)};
}

void shadow_ray_lanes(const Frame& f, Samples* s, RayPacket* rays) {
  const Eigen::Vector3f to_sun = f.photo.sun.normalized().cast<float>();
  const V3 sun = set(to_sun);
  for (size_t at = 0; at < kLanes; at += hn::Lanes(Tag())) {
    const V b[3] = {load(s->bary[0] + at), load(s->bary[1] + at), load(s->bary[2] + at)};
    const V3 normal = f.options.smooth_normals ? interpolate(b, s->of_triangle + kNormals, at)
                                               : load3(s->of_triangle + kFacet, at);
    const hn::RebindToSigned<Tag> ints;
    const Mask hit = hn::RebindMask(Tag(), hn::Load(ints, s->triangle + at) > hn::Set(ints, -1));
    store_mask(hn::And(hit, dot(normal, sun) > set(0)), s->lit + at);
    if (!f.options.cast_shadows) continue;  // the sun lights what faces it
    const V3 origin = shadow_origin(f, *s, b, normal, sun, at);
    store(origin.x, rays->org_x + at);
    store(origin.y, rays->org_y + at);
    store(origin.z, rays->org_z + at);
    store(sun.x, rays->dir_x + at);
    store(sun.y, rays->dir_y + at);
    store(sun.z, rays->dir_z + at);
  }
}

}  // namespace hookeye::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hookeye {

HWY_EXPORT(triangle_lanes);
HWY_EXPORT(barycentric_lanes);
HWY_EXPORT(shadow_ray_lanes);

void meet_triangles(const Frame& f, const Vector2d* h, Samples* s) {
  HWY_DYNAMIC_DISPATCH(triangle_lanes)(f, h, s);
  HWY_DYNAMIC_DISPATCH(barycentric_lanes)(s);
}

void shadow_rays(const Frame& f, Samples* s, RayPacket* rays) {
  HWY_DYNAMIC_DISPATCH(shadow_ray_lanes)(f, s, rays);
}

}  // namespace hookeye
#endif
