// Weighted sums of rays by triangle: a pixel's derivative. Internal to render.
#pragma once

#include <vector>

#include "render/frame.h"
#include "render/pixel_filter.h"

namespace hookeye {

/// The rays of one pixel's filter: tap (i, j) at j stride + i. Numbers of `triangle` and
/// `I` can be read up to PixelFilter::kPad beyond the last.
struct Taps {
  const int* triangle;  ///< -1: the background
  const float* I;
  const Eigen::Vector2f* uv;
  const RayRow* rays;
  int stride;
  int floats;  ///< of a row that are summed, whole vectors
};

struct TriangleSum {
  int triangle;
  RayRow sum;
};

/// Filtered intensity of a pixel, and the part of the filter that no triangle covers.
struct Filtered {
  float I, missing;
};
Filtered filter_rays(const Taps& taps, const PixelFilter& filter);

/// Adds to the triangles' sums, new ones at the end.
void sum_by_triangle(const Taps& taps, const PixelFilter& filter, std::vector<TriangleSum>* sums);

}  // namespace hookeye
