// Sixteen rays at once, whatever the processor's vectors hold. Part of translation units that
// Highway compiles once for every instruction set (foreach_target.h); no guard against repetition.
#include <hwy/highway.h>

#include <cstring>

#include "render/frame.h"

HWY_BEFORE_NAMESPACE();
namespace hookeye::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kLanes>;
using V = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

/// Three numbers a lane.
struct V3 {
  V x, y, z;
};

HWY_INLINE V set(float value) { return hn::Set(Tag(), value); }
HWY_INLINE V3 set(const Eigen::Vector3f& v) { return {set(v.x()), set(v.y()), set(v.z())}; }
HWY_INLINE V load(const float* from) { return hn::Load(Tag(), from); }
HWY_INLINE V3 load3(const Lanes* rows, size_t at) {
  return {load(rows[0] + at), load(rows[1] + at), load(rows[2] + at)};
}
HWY_INLINE void store(V v, float* to) { hn::Store(v, Tag(), to); }
HWY_INLINE Mask load_mask(const int* from) {
  return hn::RebindMask(
      Tag(), hn::Load(hn::RebindToSigned<Tag>(), from) < hn::Zero(hn::RebindToSigned<Tag>()));
}
HWY_INLINE void store_mask(Mask m, int* to) {
  const hn::RebindToSigned<Tag> ints;
  hn::Store(hn::BitCast(ints, hn::VecFromMask(Tag(), m)), ints, to);
}
HWY_INLINE V only(Mask where, V v) { return hn::IfThenElseZero(where, v); }
HWY_INLINE V3 only(Mask where, V3 v) {
  return {only(where, v.x), only(where, v.y), only(where, v.z)};
}

HWY_INLINE V3 operator+(V3 a, V3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE V3 operator-(V3 a, V3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE V3 operator*(V s, V3 a) { return {s * a.x, s * a.y, s * a.z}; }
HWY_INLINE V dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE V3 cross(V3 a, V3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE V3 transform(const Eigen::Matrix3f& R, V3 a) {
  const auto row = [&](int i) HWY_ATTR {
    return set(R(i, 0)) * a.x + set(R(i, 1)) * a.y + set(R(i, 2)) * a.z;
  };
  return {row(0), row(1), row(2)};
}
/// 1/|a|, 0 for no length.
HWY_INLINE V inverse_norm(V3 a) {
  const V square = dot(a, a);
  return only(square > set(0), set(1) / hn::Sqrt(square));
}
/// Sum over corners of b_k rows[3k..3k+2].
HWY_INLINE V3 interpolate(const V* b, const Lanes* rows, size_t at) {
  return b[0] * load3(rows, at) + b[1] * load3(rows + 3, at) + b[2] * load3(rows + 6, at);
}

/// Between numbers by lanes and lanes by numbers, `count` numbers, a multiple of four.
HWY_INLINE void to_lanes(const float* const* rows, int count, Lanes* lanes) {
  alignas(64) float fours[4 * kLanes];
  for (int k = 0; k < count; k += 4)
    for (size_t at = 0; at < kLanes; at += hn::Lanes(Tag())) {
      for (size_t i = 0; i < hn::Lanes(Tag()); ++i)
        std::memcpy(fours + 4 * i, rows[at + i] + k, 4 * sizeof(float));
      V a, b, c, d;
      hn::LoadInterleaved4(Tag(), fours, a, b, c, d);
      store(a, lanes[k] + at);
      store(b, lanes[k + 1] + at);
      store(c, lanes[k + 2] + at);
      store(d, lanes[k + 3] + at);
    }
}
HWY_INLINE void to_rows(const Lanes* lanes, int count, float* const* rows) {
  alignas(64) float fours[4 * kLanes];
  for (int k = 0; k < count; k += 4)
    for (size_t at = 0; at < kLanes; at += hn::Lanes(Tag())) {
      hn::StoreInterleaved4(load(lanes[k] + at), load(lanes[k + 1] + at), load(lanes[k + 2] + at),
                            load(lanes[k + 3] + at), Tag(), fours);
      for (size_t i = 0; i < hn::Lanes(Tag()); ++i)
        std::memcpy(rows[at + i] + k, fours + 4 * i, 4 * sizeof(float));
    }
}

}  // namespace hookeye::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
