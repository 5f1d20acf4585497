// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/shade.cpp"
#include <hwy/foreach_target.h>
// after it:
#include <hwy/contrib/math/math-inl.h>

#include "render/albedo.h"
#include "render/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace hookeye::HWY_NAMESPACE {

/// The shading normal: interpolated, or the triangle's own.
struct Normal {
  V3 n;       ///< unit
  V inverse;  ///< of the interpolated normal's length
};

Normal shading_normal(const Frame& f, const Samples& s, const V* b, size_t at) {
  if (!f.options.smooth_normals) return {load3(s.of_triangle + kFacet, at), set(1)};
  const V3 sum = interpolate(b, s.of_triangle + kNormals, at);
  const V inverse = inverse_norm(sum);
  return {inverse * sum, inverse};
}

/// The part of the light that the surface mirrors, in lit lanes.
struct Gloss {
  V I, by_specular;
  V3 by_n, by_sun;
  V3 eye, by_eye;  ///< unit vector to the camera, in camera axes
};

Gloss gloss(const Frame& f, const Samples& s, V3 n, size_t at) {
  const float strength = static_cast<float>(f.photo.sun.norm());
  const Eigen::Matrix3f R = f.view.camera.R.cast<float>();
  const V3 sun = set((f.photo.sun / f.photo.sun.norm()).cast<float>().eval());
  Gloss out;
  const V3 ray = f.view.central ? V3{load(s.h[0] + at), load(s.h[1] + at), set(1)}
                                : V3{set(0), set(0), set(1)};
  out.eye = (set(0) - inverse_norm(ray)) * ray;
  const V3 sum = sun + transform(R.transpose(), out.eye);
  const V inverse = inverse_norm(sum);
  const V3 half = inverse * sum;
  const V c = dot(n, half);
  const Mask there = hn::And(load_mask(s.lit + at), c > set(0));
  const V cosine = hn::IfThenElse(there, c, set(1));
  const V specular = set(static_cast<float>(f.photo.specular));
  const V shininess = set(static_cast<float>(f.photo.shininess));
  const V raised = only(there, hn::Exp(Tag(), shininess * hn::Log(Tag(), cosine)));
  const V slope = specular * set(strength) * shininess * raised / cosine;
  out.by_specular = set(strength) * raised;
  out.I = specular * out.by_specular;
  out.by_n = slope * half;
  const V3 by_eye = (slope * inverse) * (n - c * half);
  out.by_sun = (specular * raised) * sun + set(1 / strength) * (by_eye - dot(sun, by_eye) * sun);
  out.by_eye = transform(R, by_eye);
  return out;
}

/// Light of the whole sky on a surface that nothing hides it from.
struct Sky {
  V I;
  V3 by_n;      ///< zero where the light is even
  Mask bright;  ///< above zero: harmonics of a lamp end a little below it on its far side
};

Sky sky(const Frame& f, V3 n) {
  Sky out;
  out.I = set(static_cast<float>(f.photo.ambient));
  out.by_n = {set(0), set(0), set(0)};
  out.bright = hn::Eq(out.I, out.I);
  if (f.photo.uneven.isZero(0.0)) return out;
  const Irradiance E(f.photo.ambient, f.photo.uneven);
  const V3 b = set(E.b.cast<float>().eval());
  const V3 Qn = transform(E.Q.cast<float>(), n);
  const V I = out.I + dot(n, b + Qn);
  out.bright = I > set(0);
  out.I = only(out.bright, I);
  out.by_n = only(out.bright, b + set(2) * Qn);
  return out;
}

/// I = gain (albedo diffuse + gloss). The gain is the photo's times V = 1 / (1 + v r)^2 with the
/// camera's vignetting v and r = h.h.
struct Light {
  V gain;
  V falling;  ///< of V: -2 / (1 + v r), by v r its relative change
  V diffuse, visibility, share;
  Sky sky;
  Mask sunny;  ///< lit, and turned to the sun
  Gloss gloss;
  bool glossy;
};

/// tan^2 of the angle between ray and axis.
V off_axis(const Samples& s, size_t at) {
  const V hx = load(s.h[0] + at), hy = load(s.h[1] + at);
  return hx * hx + hy * hy;
}

Light light(const Frame& f, const Samples& s, const V* b, V3 n, bool derivatives, size_t at) {
  Light out;
  out.glossy = false;
  out.gain = set(static_cast<float>(f.photo.gain));
  out.diffuse = out.share = set(1);
  if (!f.photo.shaded) return out;
  const V passed =
      set(1) / (set(1) + set(static_cast<float>(f.photo.camera.vignetting)) * off_axis(s, at));
  out.gain = out.gain * passed * passed;
  out.falling = set(-2) * passed;
  const V3 visibility = load3(s.of_triangle + kVisibility, at);
  out.visibility = b[0] * visibility.x + b[1] * visibility.y + b[2] * visibility.z;
  // Of the hemisphere about the interpolated normal the part below the facet sends nothing:
  // cosine-weighted, (1 + n.facet)/2 remains.
  if (f.options.smooth_normals)
    out.share = set(0.5f) * (set(1) + dot(n, load3(s.of_triangle + kFacet, at)));
  const V cosine = dot(n, set(f.photo.sun.cast<float>().eval()));
  out.sunny = hn::And(load_mask(s.lit + at), cosine > set(0));
  out.sky = sky(f, n);
  out.diffuse = out.sky.I * out.visibility * out.share + only(out.sunny, cosine);
  out.glossy = !f.photo.sun.isZero(0.0) &&
               (f.photo.specular != 0 ||
                (derivatives && f.options.photo_derivative && f.options.gloss_derivative));
  if (out.glossy) out.gloss = gloss(f, s, n, at);
  return out;
}

using Values = Lanes[kRayFloats];

void store3(V3 v, int first, Values& out, size_t at) {
  store(v.x, out[first] + at);
  store(v.y, out[first + 1] + at);
  store(v.z, out[first + 2] + at);
}

void store_second(V3 v, const V* b, Values& out, size_t at) {
  for (int k = 0; k < 3; ++k) store3(b[k] * v, by_second(k), out, at);
}

/// by_sky times irradiance_by_uneven(n).
void store_uneven(V by_sky, V3 n, Values& out, size_t at) {
  const UnevenLight first = irradiance_by_uneven(Vector3d(1, 1, 1));
  const auto scale = [&](int k) HWY_ATTR { return set(static_cast<float>(first[k])) * by_sky; };
  const V axial = set(static_cast<float>(irradiance_by_uneven(Vector3d::UnitZ())[5])) * by_sky;
  const V plane = set(static_cast<float>(irradiance_by_uneven(Vector3d::UnitX())[7])) * by_sky;
  const V half = set(0.5f);
  const V by[kUnevenNumbers] = {
      scale(0) * n.y,       scale(1) * n.z,
      scale(2) * n.x,       scale(3) * n.x * n.y,
      scale(4) * n.y * n.z, axial * (n.z * n.z - half * (n.x * n.x + n.y * n.y)),
      scale(6) * n.x * n.z, plane * (n.x * n.x - n.y * n.y),
  };
  for (int k = 0; k < kUnevenNumbers; ++k) store(by[k], out[kByUneven + k] + at);
}

/// Derivatives by light and, through vertex normals, by position; adds to by_bary. Returns that by
/// the triangle's own unit normal.
V3 differentiate_light(const Frame& f, const Samples& s, const Albedo& a, const V* b,
                       const Normal& normal, const Light& l, V* by_bary, Values& out, size_t at) {
  const V gain = l.gain, albedo = load(a.value + at);
  const V3 n = normal.n, sun = set(f.photo.sun.cast<float>().eval());
  V3 by_n = only(l.sunny, (gain * albedo) * sun);
  V3 by_sun = only(l.sunny, (gain * albedo) * n);
  if (l.glossy) {
    by_n = by_n + gain * l.gloss.by_n;
    by_sun = by_sun + gain * l.gloss.by_sun;
    if (f.options.photo_derivative)
      store(gain * l.gloss.by_specular, out[kByPhoto + kSpecular] + at);
  }
  const V by_visibility = gain * albedo * l.sky.I;
  const V by_sky = only(l.sky.bright, gain * albedo * l.visibility * l.share);
  if (!f.photo.uneven.isZero(0.0)) by_n = by_n + by_sky * l.sky.by_n;
  for (int k = 0; k < 3; ++k)
    by_bary[k] = by_bary[k] + by_visibility * l.share * load(s.of_triangle[kVisibility + k] + at);
  if (f.options.photo_derivative) {
    store(by_sky, out[kByPhoto + kAmbient] + at);
    store3(by_sun, kByPhoto + kSun, out, at);
  }
  if (wants_uneven(f)) store_uneven(by_sky, n, out, at);
  if (!f.options.smooth_normals) return by_n;
  const V by_share = set(0.5f) * by_visibility * l.visibility;
  by_n = by_n + by_share * load3(s.of_triangle + kFacet, at);
  by_n = normal.inverse * (by_n - dot(n, by_n) * n);
  for (int k = 0; k < 3; ++k)
    by_bary[k] = by_bary[k] + dot(by_n, load3(s.of_triangle + kNormals + 3 * k, at));
  store_second(by_n, b, out, at);
  return by_share * n;
}

/// Derivatives by the triangle's corners: by the material point at them, times b, and by its own
/// unit normal n = c/|c|, c = e1 x e2.
struct ByCorners {
  V3 point;     ///< world axes
  V3 one, two;  ///< of corners 1 and 2 by way of n; corner 0 has minus their sum
};

void add_facet_normal(const Samples& s, V3 by_n, ByCorners* by, size_t at) {
  const Lanes* corners = s.of_triangle + kCorners;
  const V3 e1 = load3(corners + 3, at) - load3(corners, at);
  const V3 e2 = load3(corners + 6, at) - load3(corners, at);
  const V3 n = load3(s.of_triangle + kFacet, at);
  const V3 m = inverse_norm(cross(e1, e2)) * (by_n - dot(n, by_n) * n);
  by->one = cross(e2, m);
  by->two = cross(m, e1);
}

void store_corners(const ByCorners& by, const V* b, Values& out, size_t at) {
  store3(b[0] * by.point - by.one - by.two, by_position(0), out, at);
  store3(b[1] * by.point + by.one, by_position(1), out, at);
  store3(b[2] * by.point + by.two, by_position(2), out, at);
}

/// Under the fixed ray h, db = -(1 - b 1^T) Q dP b with P the corners in camera axes and Q its
/// inverse: dI = g.dx of the material point, g = -Q^T (by_bary - by_bary.b), which is upright on
/// the ray. Q_xy = A s0 (triangle_table.cpp). The camera moved by (w, v) moves all points by
/// w x p + v in its own axes; normals keep theirs with the light.
void differentiate_motion(const Frame& f, const Samples& s, const V* b, const V* by_bary,
                          V3 by_facet, const Light& l, Values& out, size_t at) {
  const Lanes* A = s.of_triangle + kRayToBary;
  const V mean = by_bary[0] * b[0] + by_bary[1] * b[1] + by_bary[2] * b[2];
  const V3 slid = {by_bary[0] - mean, by_bary[1] - mean, by_bary[2] - mean};
  const V3 ax = load3(A, at), ay = load3(A + 3, at), one = {set(1), set(1), set(1)};
  const V s0 = set(0) - load(s.of_triangle[kInverseDepth] + at);
  V3 g = {s0 * dot(ax, slid), s0 * dot(ay, slid), set(0)};
  const V hx = load(s.h[0] + at), hy = load(s.h[1] + at);
  const V zx = load(s.zoom[0] + at), zy = load(s.zoom[1] + at);
  V zoomed = set(1);
  V3 p = {hx, hy, load(s.depth + at) + set(static_cast<float>(f.view.start))};
  if (f.view.central) {
    g.z = set(0) - (hx * g.x + hy * g.y);
    const V along = dot(ax, one) * load(s.dh[0] + at) + dot(ay, one) * load(s.dh[1] + at);
    zoomed = set(-1) / (s0 * (set(1) + along));  // its depth
    p = zoomed * V3{hx, hy, set(1)};
  }
  const Eigen::Matrix3f R = f.view.camera.R.cast<float>();
  const V3 zero = {set(0), set(0), set(0)};
  ByCorners by = {transform(R.transpose(), g), zero, zero};
  V3 turn = cross(p, g);
  V by_zoom = zoomed * (zx * g.x + zy * g.y);
  if (f.photo.shaded) add_facet_normal(s, by_facet, &by, at);
  store_corners(by, b, out, at);
  if (!f.options.photo_derivative) return;
  if (l.glossy && f.photo.specular != 0) {
    // The camera turns, and the direction to it with it: d(to camera) = -w x (to camera).
    const V3 eye = l.gloss.eye, by_eye = l.gain * l.gloss.by_eye;
    turn = turn + cross(by_eye, eye);
    if (f.view.central) {
      const V inverse = inverse_norm({hx, hy, set(1)});
      const V3 seen = {inverse * zx, inverse * zy, set(0)};
      by_zoom = by_zoom + dot(by_eye, seen - dot(eye, seen) * eye);
    }
  }
  if (f.photo.shaded && f.photo.camera.vignetting != 0) {
    // the pixel's ray comes nearer to the axis: h.h falls by twice this
    const V nearer = hx * zx + hy * zy, I = load(out[kByPhoto + kLogGain] + at);
    const V strength = set(static_cast<float>(-2 * f.photo.camera.vignetting));
    by_zoom = by_zoom + strength * nearer * l.falling * I;
  }
  store3(turn, kByPhoto + kRotate, out, at);
  store3(g, kByPhoto + kMove, out, at);
  store(by_zoom, out[kByPhoto + kZoom] + at);
}

void shade_lanes(const Frame& f, const Samples& s, const Albedo& a, bool derivatives,
                 Shading* out) {
  alignas(64) Values value;
  for (size_t at = 0; at < kLanes; at += hn::Lanes(Tag())) {
    const V b[3] = {load(s.bary[0] + at), load(s.bary[1] + at), load(s.bary[2] + at)};
    const Normal normal = shading_normal(f, s, b, at);
    const Light l = light(f, s, b, normal.n, derivatives, at);
    V I = load(a.value + at) * l.diffuse;
    if (l.glossy) I = I + l.gloss.I;
    I = l.gain * I;
    store(I, out->I + at);
    if (!derivatives) continue;
    const V3 none = {set(0), set(0), set(0)};
    for (int k = 0; k < 3; ++k) store3(none, by_second(k), value, at);
    for (int k = kByPhoto; k < wanted_floats(f); ++k) store(set(0), value[k] + at);
    if (f.options.photo_derivative) {
      store(I, value[kByPhoto + kLogGain] + at);
      if (f.photo.shaded && f.options.vignetting_derivative)
        store(l.falling * off_axis(s, at) * I, value[kByVignetting] + at);
    }
    V by_bary[3];
    for (int k = 0; k < 3; ++k) by_bary[k] = l.gain * l.diffuse * load(a.by_bary[k] + at);
    V3 by_facet = none;
    if (f.photo.shaded)
      by_facet = differentiate_light(f, s, a, b, normal, l, by_bary, value, at);
    else if (f.spline)
      store_second((l.gain * l.diffuse) * load3(a.by_reference, at), b, value, at);
    differentiate_motion(f, s, b, by_bary, by_facet, l, value, at);
  }
  if (!derivatives) return;
  float* rows[kLanes];
  for (int i = 0; i < kLanes; ++i) rows[i] = out->ray[i].value;
  to_rows(value, wanted_floats(f), rows);
}

}  // namespace hookeye::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hookeye {

HWY_EXPORT(shade_lanes);

void shade(const Frame& f, const Samples& s, bool derivatives, Shading* out) {
  Albedo a;
  albedo(f, s, derivatives, &a);
  HWY_DYNAMIC_DISPATCH(shade_lanes)(f, s, a, derivatives, out);
}

}  // namespace hookeye
#endif
