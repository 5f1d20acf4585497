// The pixel filter as weights of rays on a regular grid. Internal to render.
#pragma once

#include <vector>

namespace hookeye {

/// Rays lie on a lattice with n per pixel and axis: ray (i, j) of a pixel at
///   ((i - (n-1)/2 + shift(j))/n, (j - (n-1)/2 + shift(i))/n) px from its centre.
/// The shift gives all n^2 rays different columns and rows (a canonical arrangement: Kensler,
/// Correlated Multi-Jittered Sampling, 2013): an upright edge is seen to 1/n^2 px, on a plain grid
/// to 1/n, and bodies stand upright. A pixel is the weighted mean of its rays and, where the window
/// reaches them, of `margin` further rays on each side. Rays whose weight along an axis is below
/// 1 % of the centre's are left out. A few rays see less of the window than there is (3 an axis:
/// 0.0053 px^2 of 0.0432): it is widened until their variance is the window's own, so that pictures
/// of other numbers of rays, and of renderers that take many, are as sharp to second order.
/// A pixel of a halved photo is the mean of 2^halvings by 2^halvings such pixels; `width_px` is in
/// theirs.
struct PixelFilter {
  PixelFilter(int rays_per_axis, double width_px, int halvings = 0);
  int n = 1, margin = 0;
  int taps() const { return n + 2 * margin; }
  /// Offset of a ray along one axis by its index along the other, in units of 1/n px; |.| < 1/2.
  /// Indices may be negative.
  static double shift(int index, int n) {
    const int k = index % n < 0 ? index % n + n : index % n;
    return (k - (n - 1) / 2.0) / n;
  }
  /// Weight of tap (i, j), sum 1; taps count from -margin.
  double weight(int i, int j) const { return weights_[static_cast<size_t>(j) * taps() + i]; }
  /// Weights of the taps (0, j), (1, j), ..., then zeros up to a multiple of kPad.
  const float* row(int j) const { return rows_.data() + static_cast<size_t>(j) * padded(); }
  static constexpr int kPad = 16;
  int padded() const { return (taps() + kPad - 1) / kPad * kPad; }

 private:
  double window(double px, double width_px) const;            ///< along one axis, 1 in the middle
  std::vector<double> sampled(double width_px) const;         ///< weights of a window
  double variance(const std::vector<double>& weights) const;  ///< along an axis [px^2]
  void widen(double width_px);
  int parts_ = 1;  ///< pixels along an axis that this one is the mean of
  std::vector<double> weights_;
  std::vector<float> rows_;
};

/// Blackman-Harris window (Harris 1978, 4 terms), v in units of the width; 0 for |v| >= 1/2.
double blackman_harris(double v);

}  // namespace hookeye
