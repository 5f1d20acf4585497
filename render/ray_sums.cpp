// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/ray_sums.cpp"
#include "render/ray_sums.h"

#include <hwy/foreach_target.h>

#include "render/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace hookeye::HWY_NAMESPACE {

TriangleSum& sum_of(int triangle, std::vector<TriangleSum>* sums) {
  for (TriangleSum& s : *sums)
    if (s.triangle == triangle) return s;
  TriangleSum& s = sums->emplace_back();
  s.triangle = triangle;
  std::fill_n(s.sum.value, kRayFloats, 0.0f);
  return s;
}

/// Taps (first .. first + count) of a row.
HWY_INLINE void add_run(const RayRow* rays, const float* weights, int count, size_t floats,
                        RayRow* sum) {
  for (size_t at = 0; at < floats; at += hn::Lanes(Tag())) {
    V v = load(sum->value + at);
    for (int i = 0; i < count; ++i) v = v + set(weights[i]) * load(rays[i].value + at);
    store(v, sum->value + at);
  }
}

bool all_on(int triangle, const Taps& taps, const PixelFilter& filter) {
  const hn::RebindToSigned<Tag> ints;
  const auto wanted = hn::Set(ints, triangle);
  for (int j = 0; j < filter.taps(); ++j)
    for (int i = 0; i < filter.padded(); i += static_cast<int>(hn::Lanes(ints))) {
      const auto at = hn::LoadU(ints, taps.triangle + j * taps.stride + i);
      const Mask other = hn::RebindMask(Tag(), hn::Ne(at, wanted));
      if (!hn::AllFalse(Tag(), hn::And(other, hn::LoadU(Tag(), filter.row(j) + i) > set(0))))
        return false;
    }
  return true;
}

void sum_rays(const Taps& taps, const PixelFilter& filter, std::vector<TriangleSum>* sums) {
  const int size = filter.taps();
  const auto floats = static_cast<size_t>(taps.floats);
  if (all_on(taps.triangle[0], taps, filter)) {
    RayRow& sum = sum_of(taps.triangle[0], sums).sum;
    for (size_t at = 0; at < floats; at += hn::Lanes(Tag())) {
      V v = load(sum.value + at);
      for (int j = 0; j < size; ++j) {
        const RayRow* ray = taps.rays + j * taps.stride;
        for (int i = 0; i < size; ++i) v = v + set(filter.row(j)[i]) * load(ray[i].value + at);
      }
      store(v, sum.value + at);
    }
    return;
  }
  for (int j = 0; j < size; ++j) {
    const int* triangle = taps.triangle + j * taps.stride;
    for (int i = 0, end = 0; i < size; i = end) {
      for (end = i + 1; end < size && triangle[end] == triangle[i]; ++end) continue;
      if (triangle[i] >= 0)
        add_run(taps.rays + j * taps.stride + i, filter.row(j) + i, end - i, floats,
                &sum_of(triangle[i], sums).sum);
    }
  }
}

/// In double: differences of pictures by small steps are looked at.
Filtered filter_lanes(const Taps& taps, const PixelFilter& filter) {
  const hn::CappedTag<double, kLanes / 2> wide;
  const hn::Rebind<float, decltype(wide)> floats;
  const hn::RebindToSigned<decltype(floats)> ints;
  auto I = hn::Zero(wide), missing = I;
  for (int j = 0; j < filter.taps(); ++j)
    for (int i = 0; i < filter.taps(); i += static_cast<int>(hn::Lanes(wide))) {
      const auto w = hn::LoadU(floats, filter.row(j) + i);
      const auto triangle = hn::LoadU(ints, taps.triangle + j * taps.stride + i);
      const auto seen = hn::LoadU(floats, taps.I + j * taps.stride + i);
      const auto inside = hn::IfThenElseZero(w > hn::Zero(floats), seen);
      const auto none = hn::RebindMask(floats, triangle < hn::Zero(ints));
      I = I + hn::PromoteTo(wide, w) * hn::PromoteTo(wide, inside);
      missing = missing + hn::PromoteTo(wide, hn::IfThenElseZero(none, w));
    }
  return {static_cast<float>(hn::GetLane(hn::SumOfLanes(wide, I))),
          static_cast<float>(hn::GetLane(hn::SumOfLanes(wide, missing)))};
}

}  // namespace hookeye::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hookeye {

HWY_EXPORT(sum_rays);
HWY_EXPORT(filter_lanes);

void sum_by_triangle(const Taps& taps, const PixelFilter& filter, std::vector<TriangleSum>* sums) {
  HWY_DYNAMIC_DISPATCH(sum_rays)(taps, filter, sums);
}

Filtered filter_rays(const Taps& taps, const PixelFilter& filter) {
  return HWY_DYNAMIC_DISPATCH(filter_lanes)(taps, filter);
}

}  // namespace hookeye
#endif
