// The pixels of one picture, band by band. Internal to render.
#pragma once

#include <vector>

#include "render/frame.h"
#include "render/pixel_filter.h"

namespace hookeye {

struct BandTask {
  const Frame& frame;
  const PixelFilter& filter;
  const RayGrid& grid;
  bool silhouette;
  const std::vector<unsigned char>* count;
  const std::vector<EdgeSegment>& edges;  ///< silhouettes, by pixel in ascending order

  bool wants(int pixel) const { return !count || (*count)[pixel]; }
};

/// Renders rows [row, last_row): writes into `out` (its rows only) and into `part`, silhouettes
/// included, all but the column kBlur.
void render_band(const BandTask& task, int row, int last_row, Rendering* out,
                 ImageDerivative::Part* part);

/// Pixels outside the view's rows and columns, which only silhouettes reach.
void add_outer_edges(const BandTask& task, ImageDerivative::Part* part);

}  // namespace hookeye
