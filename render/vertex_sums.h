// Sums of a photo's pixels by vertices: the inner loops of condensed.cpp. Internal to render.
#pragma once

#include <cstddef>
#include <vector>

#include "render/optics.h"

namespace hookeye {

constexpr int kVertexFloats = 8;  ///< position 0-2, normal or reference position 3-5, two zeros
constexpr int kPhotoFloats = 16;  ///< kPhotoColumns and a zero
static_assert(kPhotoColumns <= kPhotoFloats);

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
struct VertexSums {
  std::vector<VertexBlock> block;
  std::vector<VertexRow> vertex;
  PhotoBlock photo;
};

/// One pixel's derivatives g and what they are summed with.
struct PixelRow {
  const float* vertices;             ///< kVertexFloats of each
  const float* photo;                ///< kPhotoColumns
  const std::vector<int>& slots;     ///< of VertexSums::vertex
  const std::vector<size_t>& block;  ///< of pairs (i, j), i <= j, row by row
  float w, Bt_r;
};

/// M += w^2 g g^T, b += Bt_r g.
void add_pixel(const PixelRow& pixel, VertexSums* sums);

/// Y += factor block Z for `rows` numbers of a vertex, row-major with `columns` columns.
struct ProductSize {
  int rows, columns;
};
void add_product(const VertexBlock& block, double factor, ProductSize size, const double* Z,
                 double* Y);

}  // namespace hookeye
