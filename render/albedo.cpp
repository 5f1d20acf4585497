// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/albedo.cpp"
#include "render/albedo.h"

#include <hwy/foreach_target.h>

#include <algorithm>

#include "render/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace hookeye::HWY_NAMESPACE {

/// Bilinear between texels; the border is repeated outwards.
void image_lanes(const Image& image, const Samples& s, Albedo* out) {
  const hn::RebindToSigned<Tag> ints;
  using Ints = hn::Vec<decltype(ints)>;
  const auto clamped = [&](Ints i, int size) HWY_ATTR {
    return hn::Min(hn::Max(i, hn::Zero(ints)), hn::Set(ints, size - 1));
  };
  const Ints one = hn::Set(ints, 1), width = hn::Set(ints, image.width);
  const Lanes* texels = s.of_triangle + kTexels;
  for (size_t at = 0; at < kLanes; at += hn::Lanes(Tag())) {
    V x = set(0), y = set(0);
    for (int k = 0; k < 3; ++k) {
      x = x + load(s.bary[k] + at) * load(texels[2 * k] + at);
      y = y + load(s.bary[k] + at) * load(texels[2 * k + 1] + at);
    }
    const V a = x - hn::Floor(x), b = y - hn::Floor(y);
    const Ints ix = hn::Load(ints, s.texel[0] + at) + hn::ConvertTo(ints, hn::Floor(x));
    const Ints iy = hn::Load(ints, s.texel[1] + at) + hn::ConvertTo(ints, hn::Floor(y));
    const Ints x0 = clamped(ix, image.width), x1 = clamped(ix + one, image.width);
    const Ints row0 = width * clamped(iy, image.height);
    const Ints row1 = width * clamped(iy + one, image.height);
    const float* I = image.values.data();
    const V p00 = hn::GatherIndex(Tag(), I, row0 + x0), p10 = hn::GatherIndex(Tag(), I, row0 + x1);
    const V p01 = hn::GatherIndex(Tag(), I, row1 + x0), p11 = hn::GatherIndex(Tag(), I, row1 + x1);
    const V top = p00 + a * (p10 - p00), bottom = p01 + a * (p11 - p01);
    const V by_x = (set(1) - b) * (p10 - p00) + b * (p11 - p01), by_y = bottom - top;
    store(top + b * by_y, out->value + at);
    for (int k = 0; k < 3; ++k)
      store(by_x * load(texels[2 * k] + at) + by_y * load(texels[2 * k + 1] + at),
            out->by_bary[k] + at);
  }
}

}  // namespace hookeye::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hookeye {

HWY_EXPORT(image_lanes);

namespace {

void from_photo(const Frame& f, const Samples& s, bool derivatives, Albedo* out) {
  const View& view = *f.reference_view;
  for (int i = 0; i < s.count; ++i) {
    if (s.triangle[i] < 0) continue;
    const auto& t = f.state.surface.triangles[s.triangle[i]];
    Camera::Jacobian3 by_point;
    Camera::Jacobian7 by_camera;
    const Vector3d p = interpolate(view.p, t, s, i);
    const Vector2d px =
        derivatives ? view.local.project(p, &by_point, &by_camera) : view.local.project(p);
    const Lookup at = f.spline->at(px);
    out->value[i] = static_cast<float>(at.value / f.texture.reference_gain);
    if (!derivatives) continue;
    const Vector3d g = by_point.transpose() * at.gradient / f.texture.reference_gain;
    for (int k = 0; k < 3; ++k)
      out->by_bary[k][i] = static_cast<float>(g.dot(view.p.col(t[k]) - p));
    const Vector3d by_reference = view.camera.R.transpose() * g;
    for (int c = 0; c < 3; ++c) out->by_reference[c][i] = static_cast<float>(by_reference[c]);
  }
}

}  // namespace

void albedo(const Frame& f, const Samples& s, bool derivatives, Albedo* out) {
  if (f.texture.source == Texture::Source::image)
    return HWY_DYNAMIC_DISPATCH(image_lanes)(*f.texture.image, s, out);
  for (int i = 0; i < kLanes; ++i) {
    out->value[i] = static_cast<float>(f.texture.albedo);
    for (int k = 0; k < 3; ++k) out->by_bary[k][i] = out->by_reference[k][i] = 0;
  }
  if (f.texture.source == Texture::Source::photo) from_photo(f, s, derivatives, out);
}

}  // namespace hookeye
#endif
