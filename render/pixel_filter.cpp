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

namespace {

/// Variance of the window itself in units of width^2 (its mean square, by the trapezoidal rule).
double window_variance() {
  constexpr int kSteps = 2000;
  double sum = 0, square = 0;
  for (int i = 1; i < kSteps; ++i) {
    const double v = static_cast<double>(i) / kSteps - 0.5;
    sum += blackman_harris(v);
    square += blackman_harris(v) * v * v;
  }
  return square / sum;
}

}  // namespace

double PixelFilter::window(double px, double width_px) const {
  double sum = 0;
  for (int i = 0; i < parts_; ++i)
    sum += blackman_harris((px * parts_ - i + (parts_ - 1) / 2.0) / width_px);
  return sum;
}

std::vector<double> PixelFilter::sampled(double width_px) const {
  const auto place = [&](int tap, int other) {
    return (tap - margin - (n - 1) / 2.0 + shift(other - margin, n)) / n;
  };
  std::vector<double> weights;
  double sum = 0;
  for (int j = 0; j < taps(); ++j)
    for (int i = 0; i < taps(); ++i)
      sum += weights.emplace_back(window(place(i, j), width_px) * window(place(j, i), width_px));
  if (sum <= 0)  // A window narrower than the ray spacing of an even pattern: the plain mean.
    weights.assign(weights.size(), 1.0), sum = static_cast<double>(weights.size());
  for (double& w : weights) w /= sum;
  return weights;
}

double PixelFilter::variance(const std::vector<double>& weights) const {
  double out = 0;
  for (int j = 0; j < taps(); ++j)
    for (int i = 0; i < taps(); ++i) {
      const double px = (i - margin - (n - 1) / 2.0 + shift(j - margin, n)) / n;
      out += weights[static_cast<size_t>(j) * taps() + i] * px * px;
    }
  return out;
}

PixelFilter::PixelFilter(int rays_per_axis, double width_px, int halvings)
    : n(rays_per_axis), parts_(1 << halvings) {
  const double least = 0.01 * window(0.0, width_px);
  // Offsets of the first ray outside the pixel: (n+1)/2/n px, then one more ray each.
  while (window(((n + 1) / 2.0 + margin) / n, width_px) > least) ++margin;
  weights_ = sampled(width_px);
  widen(width_px);
  rows_.assign(static_cast<size_t>(taps()) * padded(), 0.0f);
  for (int j = 0; j < taps(); ++j)
    for (int i = 0; i < taps(); ++i)
      rows_[static_cast<size_t>(j) * padded() + i] = static_cast<float>(weight(i, j));
}

/// To the variance of a window of that width.
void PixelFilter::widen(double width_px) {
  const double finer = 1.0 / (double(parts_) * parts_);
  const double wanted = window_variance() * width_px * width_px * finer + (1.0 - finer) / 12.0;
  double narrow = width_px, wide = 2.0 * width_px;
  if (variance(sampled(wide)) < wanted) return;  // one ray, or a window narrower than its spacing
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (narrow + wide);
    (variance(sampled(middle)) < wanted ? narrow : wide) = middle;
  }
  weights_ = sampled(wide);
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
