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

}  // namespace hookeye
