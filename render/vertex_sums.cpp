// Highway compiles this file once for each instruction set and picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/vertex_sums.cpp"
#include "render/vertex_sums.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hookeye::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Rows of numbers, one for each pixel of a run.
struct Rows {
  const float* first;
  size_t step;
  const float* of(int pixel) const { return first + pixel * step; }
};

/// to[r] += sum over pixels of weight factors[r] from, r < kRows: rows of kCount floats that stay
/// in registers meanwhile.
template <int kRows, int kCount>
HWY_INLINE void add_outer(Rows factors, Rows from, const float* weight, int pixels,
                          float (*to)[kCount]) {
  const hn::CappedTag<float, kCount> tag;
  for (size_t at = 0; at < kCount; at += hn::Lanes(tag)) {
    hn::Vec<decltype(tag)> sum[kRows];
    for (int r = 0; r < kRows; ++r) sum[r] = hn::Load(tag, to[r] + at);
    for (int k = 0; k < pixels; ++k) {
      const auto v = hn::Set(tag, weight[k]) * hn::LoadU(tag, from.of(k) + at);
      const float* factor = factors.of(k);
      for (int r = 0; r < kRows; ++r) sum[r] = hn::MulAdd(hn::Set(tag, factor[r]), v, sum[r]);
    }
    for (int r = 0; r < kRows; ++r) hn::Store(sum[r], tag, to[r] + at);
  }
}

constexpr float kOne[1] = {1};

template <int kNumbers>
HWY_INLINE void add_vertices(const PixelRun& p, VertexSums* sums) {
  const size_t* block = p.block.data();
  const auto slot = [&](size_t i) { return Rows{p.vertices + p.of_slot[i], p.step}; };
  const Rows photo = {p.with_photo ? p.photo->data() : nullptr, kPhotoFloats}, one = {kOne, 0};
  const Rows uneven = {p.uneven ? p.uneven->data() : nullptr, kUnevenNumbers};
  for (size_t i = 0; i < p.slots.size(); ++i) {
    VertexRow& row = sums->vertex[p.slots[i]];
    if (p.uneven)
      add_outer<kNumbers, kUnevenNumbers>(slot(i), uneven, p.ww, p.count,
                                          sums->uneven_vertex[p.slots[i]].uneven);
    if (p.with_photo) add_outer<kNumbers, kPhotoFloats>(slot(i), photo, p.ww, p.count, row.photo);
    add_outer<1, kVertexFloats>(one, slot(i), p.Bt_r, p.count, &row.b);
    for (size_t j = i; j < p.slots.size(); ++j, ++block)
      add_outer<kNumbers, kVertexFloats>(slot(j), slot(i), p.ww, p.count,
                                         sums->block[*block].value);
  }
}

void add_pixels_lanes(const PixelRun& p, VertexSums* sums) {
  if (p.numbers == 3)
    add_vertices<3>(p, sums);
  else
    add_vertices<6>(p, sums);
  if (!p.with_photo) return;
  const Rows photo = {p.photo->data(), kPhotoFloats}, one = {kOne, 0};
  add_outer<kUneven, kPhotoFloats>(photo, photo, p.ww, p.count, sums->photo.photo);
  add_outer<1, kPhotoFloats>(one, photo, p.Bt_r, p.count, &sums->photo.b);
  if (!p.uneven) return;
  const Rows uneven = {p.uneven->data(), kUnevenNumbers};
  add_outer<kUnevenNumbers, kPhotoFloats>(uneven, photo, p.ww, p.count, sums->uneven.photo);
  add_outer<kUnevenNumbers, kUnevenNumbers>(uneven, uneven, p.ww, p.count, sums->uneven.uneven);
  add_outer<1, kUnevenNumbers>(one, uneven, p.Bt_r, p.count, &sums->uneven.b);
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

HWY_EXPORT(add_pixels_lanes);
HWY_EXPORT(add_product_lanes);

void add_pixels(const PixelRun& run, VertexSums* sums) {
  HWY_DYNAMIC_DISPATCH(add_pixels_lanes)(run, sums);
}

void add_product(const VertexBlock& block, double factor, ProductSize size, const double* Z,
                 double* Y) {
  HWY_DYNAMIC_DISPATCH(add_product_lanes)(block, factor, size, Z, Y);
}

}  // namespace hookeye
#endif
