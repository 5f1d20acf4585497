// The pixels of one picture, band by band. Internal to render.
#pragma once

#include <vector>

#include "render/frame.h"
#include "render/pixel_filter.h"

namespace hookeye {

/// Wanted pixels of a row with their interior derivatives, in ascending order.
struct RowDerivative {
  std::vector<int> pixel, first;  ///< segments of pixel[i] end at first[i] (exclusive)
  std::vector<DerivativeSegment> segments;
  std::vector<Eigen::Matrix<float, kPhotoColumns, 1>> photo;
};

struct BandDerivative {
  std::vector<RowDerivative> rows;
};

struct BandTask {
  const Frame& frame;
  const PixelFilter& filter;
  const RayGrid& grid;
  bool silhouette;
  const std::vector<unsigned char>* count;
};

/// Renders rows [row, last_row): writes into `out` (its rows only) and into `band`.
void render_band(const BandTask& task, int row, int last_row, Rendering* out, BandDerivative* band);

/// Joins the bands and the silhouettes into one list by pixels; fills all columns but kBlur.
ImageDerivative join(const std::vector<BandDerivative>& bands, std::vector<EdgeSegment> edges,
                     const BandTask& task);

}  // namespace hookeye
