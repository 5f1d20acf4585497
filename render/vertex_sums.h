// Sums of a photo's pixels by vertices: the inner loops of condensed.cpp. Internal to render.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "render/renderer.h"

namespace hookeye {

constexpr int kVertexFloats = 8;  ///< position 0-2, normal or reference position 3-5, and two

/// Floats: each sums the few hundred pixels about a vertex.
struct alignas(64) VertexBlock {
  float value[kVertexFloats][kVertexFloats] = {};  ///< [number of the later][of the earlier]
};
struct alignas(64) VertexRow {
  float photo[6][kPhotoFloats] = {};  ///< with the photo's numbers
  float b[kVertexFloats] = {};
};
struct alignas(64) PhotoBlock {
  float photo[kPhotoFloats][kPhotoFloats] = {};
  float b[kPhotoFloats] = {};
};
/// The same with the numbers of the uneven light.
struct alignas(64) UnevenRow {
  float uneven[6][kUnevenNumbers] = {};
};
struct alignas(64) UnevenBlock {
  float photo[kUnevenNumbers][kPhotoFloats] = {};
  float uneven[kUnevenNumbers][kUnevenNumbers] = {};
  float b[kUnevenNumbers] = {};
};
struct VertexSums {
  std::vector<VertexBlock> block;
  std::vector<VertexRow> vertex;
  std::vector<UnevenRow> uneven_vertex;  ///< as `vertex`, or empty
  PhotoBlock photo;
  UnevenBlock uneven;
};

/// Derivatives g of neighbouring pixels by the same vertices and by the photo's numbers.
struct PixelRun {
  static constexpr int kPixels = 16;
  std::span<const int> slots;     ///< of VertexSums::vertex
  std::span<const size_t> block;  ///< of slots (i, j), i <= j, row by row
  int numbers = 6;                ///< of a vertex: 6, or 3 where the last three are zero
  bool with_photo = true;         ///< false: nothing is summed with the photo's numbers
  int count = 0;                  ///< pixels
  /// By vertex, kVertexFloats from the first pixel's on; what stands in the last two does not
  /// count. The next pixel's are `step` floats later, those of slot i `of_slot[i]`.
  const float* vertices = nullptr;
  size_t step = 0;
  std::span<const size_t> of_slot;
  const PhotoDerivative* photo = nullptr;    ///< of the first; the others follow
  const UnevenDerivative* uneven = nullptr;  ///< the same; null: not summed
  float ww[kPixels], Bt_r[kPixels];
};

/// M += ww g g^T, b += Bt_r g.
void add_pixels(const PixelRun& run, VertexSums* sums);

/// Y += factor block Z for `rows` numbers of a vertex, row-major with `columns` columns.
struct ProductSize {
  int rows, columns;
};
void add_product(const VertexBlock& block, double factor, ProductSize size, const double* Z,
                 double* Y);

}  // namespace hookeye
