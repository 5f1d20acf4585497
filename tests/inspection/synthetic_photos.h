// Photos of speckled faces made of formulas alone, with a motion that is known at every pixel.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "capture_io/image.h"

namespace hookeye::test {

/// Smooth noise on a grid of `spacing` px, 0 .. 1: speckles of about that size wherever it is
/// asked.
class Speckle {
 public:
  Speckle(unsigned seed, double spacing) : spacing_(spacing), values_(kSize * kSize) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (double& v : values_) v = uniform(random);
  }
  double at(const Eigen::Vector2d& X) const {
    const double x = X.x() / spacing_ + 100.0, y = X.y() / spacing_ + 100.0;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double s = ease(x - i), t = ease(y - j);
    return (1 - t) * ((1 - s) * value(i, j) + s * value(i + 1, j)) +
           t * ((1 - s) * value(i, j + 1) + s * value(i + 1, j + 1));
  }

 private:
  static constexpr int kSize = 512;
  double value(int i, int j) const { return values_[size_t((j % kSize) * kSize + i % kSize)]; }
  double spacing_;
  std::vector<double> values_;
};

/// Every pixel by `radiance` of its place; `noise`: standard deviation; stored in steps of 8 bits.
inline Image photographed(int width, int height,
                          const std::function<double(const Eigen::Vector2d&)>& radiance,
                          double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  Image out;
  out.width = width, out.height = height, out.channels = 1;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double v = radiance({double(x), double(y)}) + noise * normal(random);
      out.values.push_back(static_cast<float>(std::round(255.0 * std::clamp(v, 0.0, 1.0)) / 255.0));
    }
  return out;
}

}  // namespace hookeye::test
