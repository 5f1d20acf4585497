#include "estimation/images/unresolved.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace hookeye {

namespace {

constexpr int kReach = 7;           ///< taps to either side; those beyond are below 6e-4
constexpr double kNearby_px = 1.5;  ///< a pattern's edge is that wide, and errors are at edges

/// Of a wave of `w` [rad/px], what a cubic B-spline through the pixels has half way between them.
double half_way(double w) {
  const double at_halves = 23.0 / 24.0 * std::cos(0.5 * w) + 1.0 / 24.0 * std::cos(1.5 * w);
  return at_halves / (2.0 / 3.0 + 1.0 / 3.0 * std::cos(w));
}

/// The filter 1 - half_way^2: there and back again.
std::vector<float> lost() {
  constexpr int kSteps = 4096;
  std::vector<float> taps;
  for (int n = -kReach; n <= kReach; ++n) {
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double w = M_PI * (i + 0.5) / kSteps, kept = half_way(w);
      sum += (1.0 - kept * kept) * std::cos(n * w);
    }
    taps.push_back(static_cast<float>(sum / kSteps));
  }
  return taps;
}

}  // namespace

Image unresolved_variance(const Image& image, const Image& sigma) {
  static const std::vector<float> taps = lost();
  const std::vector<float> none = {1.0f};
  double of_noise = 0.0;
  for (const float tap : taps) of_noise += 2.0 * tap * tap;
  const cv::Mat I(image.height, image.width, CV_32F, const_cast<float*>(image.values.data()));
  cv::Mat rows, columns;
  cv::sepFilter2D(I, rows, CV_32F, taps, none, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
  cv::sepFilter2D(I, columns, CV_32F, none, taps, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
  Image out{image.width, image.height, 1, std::vector<float>(image.pixels())};
  cv::Mat sum(image.height, image.width, CV_32F, out.values.data());
  cv::Mat(rows.mul(rows) + columns.mul(columns)).copyTo(sum);
  cv::GaussianBlur(sum, sum, {0, 0}, kNearby_px, kNearby_px, cv::BORDER_REPLICATE);
  for (size_t i = 0; i < out.values.size(); ++i)
    out.values[i] = std::max(
        0.0f, out.values[i] - static_cast<float>(of_noise) * sigma.values[i] * sigma.values[i]);
  return out;
}

BlurredNoise blurred_noise(double blur_variance_px2) {
  // Power of a wave over all parts of a pixel: B-splines of order 7 over those of order 3, squared
  // (Unser 1999). blur() leaves exp(-v (1 - cos w)) of its amplitude along each axis.
  constexpr int kSteps = 512;
  double all = 0.0, left = 0.0, by_variance = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double w = M_PI * (i + 0.5) / kSteps, falls = 2.0 * (1.0 - std::cos(w));
    const double power =
        (2416.0 + 2382.0 * std::cos(w) + 240.0 * std::cos(2.0 * w) + 2.0 * std::cos(3.0 * w)) /
        5040.0 / std::pow((2.0 + std::cos(w)) / 3.0, 2);
    const double kept = power * std::exp(-blur_variance_px2 * falls);
    all += power, left += kept, by_variance -= falls * kept;
  }
  left /= all, by_variance /= all;
  return {left * left, 2.0 * left * by_variance};
}

}  // namespace hookeye
