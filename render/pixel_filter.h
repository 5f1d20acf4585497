// The pixel filter as weights of rays on a regular grid. Internal to render.
#pragma once

#include <vector>

namespace hookeye {

/// Rays lie on a grid with n per pixel and axis, at (i - (n-1)/2)/n px from the pixel centre. A
/// pixel is the weighted mean of its n^2 rays and, where the window reaches them, of `margin`
/// further rays on each side. Rays whose weight is below 1 % of the centre's are left out (at
/// n = 3 and 1.5 px width: the outer taps at 2/3 px, of 0.2 %).
struct PixelFilter {
  PixelFilter(int rays_per_axis, double width_px);
  int n = 1, margin = 0;
  int taps() const { return n + 2 * margin; }
  /// Weights along one axis, sum 1; tap i is at (i - margin - (n-1)/2)/n px.
  std::vector<double> axis;
  double offset_px(int tap) const { return (tap - margin - (n - 1) / 2.0) / n; }
};

/// Blackman-Harris window (Harris 1978, 4 terms), v in units of the width; 0 for |v| >= 1/2.
double blackman_harris(double v);

}  // namespace hookeye
