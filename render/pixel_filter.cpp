#include "render/pixel_filter.h"

#include <cmath>
#include <numbers>

#include "render/renderer.h"

namespace hookeye {

double blackman_harris(double v) {
  if (std::abs(v) >= 0.5) return 0.0;
  const double a = 2 * std::numbers::pi * (v + 0.5);
  return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2 * a) - 0.01168 * std::cos(3 * a);
}

PixelFilter::PixelFilter(int rays_per_axis, double width_px) : n(rays_per_axis) {
  const double least = 0.01 * blackman_harris(0.0);
  // Offsets of the first ray outside the pixel: (n+1)/2/n px, then one more ray each.
  while (blackman_harris(((n + 1) / 2.0 + margin) / n / width_px) > least) ++margin;
  const auto along = [&](int tap, int other) {
    const double px = (tap - margin - (n - 1) / 2.0 + shift(other - margin, n)) / n;
    return blackman_harris(px / width_px);
  };
  double sum = 0;
  for (int j = 0; j < taps(); ++j)
    for (int i = 0; i < taps(); ++i) sum += weights_.emplace_back(along(i, j) * along(j, i));
  if (sum <= 0)  // A window narrower than the ray spacing of an even pattern: the plain mean.
    weights_.assign(weights_.size(), 1.0), sum = static_cast<double>(weights_.size());
  for (double& w : weights_) w /= sum;
}

namespace {

/// T(n, v) = exp(-v) I_n(v), the discrete Gaussian (Lindeberg 1990), until the tail is below 1e-9.
std::vector<double> discrete_gaussian(double variance) {
  std::vector<double> half;
  double sum = 0;
  do {
    half.push_back(std::exp(-variance) * std::cyl_bessel_i(double(half.size()), variance));
    sum += half.size() == 1 ? half.back() : 2 * half.back();
  } while (1 - sum > 1e-9 && half.size() < 200);
  for (double& t : half) t /= sum;
  return half;
}

void blur_lines(const float* from, float* to, int lines, int line_step, int length, int step,
                const std::vector<double>& half) {
  const int reach = static_cast<int>(half.size()) - 1;
  for (int line = 0; line < lines; ++line)
    for (int i = 0; i < length; ++i) {
      double sum = half[0] * from[line * line_step + i * step];
      for (int k = 1; k <= reach; ++k)
        sum += half[k] * (double(from[line * line_step + std::max(i - k, 0) * step]) +
                          from[line * line_step + std::min(i + k, length - 1) * step]);
      to[line * line_step + i * step] = static_cast<float>(sum);
    }
}

}  // namespace

Image blur(const Image& image, double variance_px2) {
  if (variance_px2 <= 0 || image.values.empty()) return image;
  const std::vector<double> half = discrete_gaussian(variance_px2);
  Image across = image, out = image;
  const int c = image.channels;
  for (int k = 0; k < c; ++k) {
    blur_lines(image.values.data() + k, across.values.data() + k, image.height, image.width * c,
               image.width, c, half);
    blur_lines(across.values.data() + k, out.values.data() + k, image.width, c, image.height,
               image.width * c, half);
  }
  return out;
}

}  // namespace hookeye
