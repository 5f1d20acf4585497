// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/vertex_sums.cpp"
#include "render/vertex_sums.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace hookeye::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// to += factor from, kCount floats.
template <int kCount>
HWY_INLINE void add_scaled(float factor, const float* from, float* to) {
  const hn::CappedTag<float, kCount> tag;
  const auto f = hn::Set(tag, factor);
  for (size_t i = 0; i < kCount; i += hn::Lanes(tag))
    hn::Store(hn::Load(tag, to + i) + f * hn::Load(tag, from + i), tag, to + i);
}

void add_pixel_lanes(const PixelRow& p, VertexSums* sums) {
  alignas(64) float photo[kPhotoFloats] = {}, weighted[kPhotoFloats];
  std::copy_n(p.photo, kPhotoColumns, photo);
  const float ww = p.w * p.w;
  for (int k = 0; k < kPhotoFloats; ++k) weighted[k] = ww * photo[k];
  const size_t* block = p.block.data();
  const size_t count = p.slots.size();
  for (size_t i = 0; i < count; ++i) {
    alignas(64) float g[kVertexFloats];
    std::copy_n(p.vertices + i * kVertexFloats, kVertexFloats, g);
    VertexRow& row = sums->vertex[p.slots[i]];
    for (int c = 0; c < 6; ++c) add_scaled<kPhotoFloats>(g[c], weighted, row.photo[c]);
    add_scaled<kVertexFloats>(p.Bt_r, g, row.b);
    for (size_t j = i; j < count; ++j, ++block) {
      const float* other = p.vertices + j * kVertexFloats;
      for (int c = 0; c < 6; ++c)
        add_scaled<kVertexFloats>(ww * other[c], g, sums->block[*block].value[c]);
    }
  }
  for (int k = 0; k < kPhotoColumns; ++k)
    add_scaled<kPhotoFloats>(photo[k], weighted, sums->photo.photo[k]);
  add_scaled<kPhotoFloats>(p.Bt_r, photo, sums->photo.b);
}

/// Rows kRows of Y at once, one vector of columns after the other.
template <int kRows>
HWY_INLINE void add_rows(const VertexBlock& block, double factor, int columns, const double* Z,
                         double* Y) {
  const hn::ScalableTag<double> tag;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  double a[kRows][kRows];
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kRows; ++c) a[r][c] = factor * block.value[c][r];
  int at = 0;
  for (; at + lanes <= columns; at += lanes)
    for (int r = 0; r < kRows; ++r) {
      auto y = hn::LoadU(tag, Y + r * columns + at);
      for (int c = 0; c < kRows; ++c)
        y = y + hn::Set(tag, a[r][c]) * hn::LoadU(tag, Z + c * columns + at);
      hn::StoreU(y, tag, Y + r * columns + at);
    }
  for (; at < columns; ++at)
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kRows; ++c) Y[r * columns + at] += a[r][c] * Z[c * columns + at];
}

void add_product_lanes(const VertexBlock& block, double factor, ProductSize size, const double* Z,
                       double* Y) {
  if (size.rows == 3)
    add_rows<3>(block, factor, size.columns, Z, Y);
  else
    add_rows<6>(block, factor, size.columns, Z, Y);
}

}  // namespace hookeye::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hookeye {

HWY_EXPORT(add_pixel_lanes);
HWY_EXPORT(add_product_lanes);

void add_pixel(const PixelRow& pixel, VertexSums* sums) {
  HWY_DYNAMIC_DISPATCH(add_pixel_lanes)(pixel, sums);
}

void add_product(const VertexBlock& block, double factor, ProductSize size, const double* Z,
                 double* Y) {
  HWY_DYNAMIC_DISPATCH(add_product_lanes)(block, factor, size, Z, Y);
}

}  // namespace hookeye
#endif
