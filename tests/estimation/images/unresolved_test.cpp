// What a texture from a photo lacks, against pictures of patterns that are known everywhere.
#include "estimation/images/unresolved.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "render/texture_lookup.h"

namespace hookeye {
namespace {

constexpr int kFine = 8;     ///< points of the pattern along a pixel
constexpr int kPixels = 88;  ///< along a picture

/// A pattern by its points, row by row.
using Points = Eigen::ArrayXXf;

/// Dark dots on white, `radius` px wide and less high: seen from the side.
Points dots(double radius, double flat) {
  const int side = (kPixels + 2) * kFine;
  Points out = Points::Ones(side, side);
  std::mt19937 draw(4);
  std::uniform_real_distribution<double> place(0.0, side), share(0.7, 1.3);
  const int count = static_cast<int>(0.35 * kPixels * kPixels / (M_PI * radius * radius * flat));
  for (int i = 0; i < count; ++i) {
    const double r = radius * kFine * share(draw), x = place(draw), y = place(draw);
    for (int row = std::max(0, int(y - r)); row < std::min<int>(side, int(y + r) + 2); ++row)
      for (int column = std::max(0, int(x - r)); column < std::min<int>(side, int(x + r) + 2);
           ++column)
        if (std::hypot(column - x, (row - y) / flat) < r) out(row, column) = 0.2f;
  }
  return out;
}

/// Means over `width` points along the rows.
Points blurred(const Points& of, int width) {
  Points out = of;
  for (Eigen::Index row = 0; row < of.rows(); ++row)
    for (Eigen::Index column = 0; column < of.cols(); ++column) {
      const auto from = std::max<Eigen::Index>(0, column - width / 2);
      const auto to = std::min<Eigen::Index>(of.cols(), column - width / 2 + width);
      out(row, column) = of.row(row).segment(from, to - from).mean();
    }
  return out;
}

Points blurred_both_ways(const Points& of, int width) {
  return blurred(blurred(of, width).transpose(), width).transpose();
}

/// As square pixels see it through a lens that blurs by `blur_px`: three boxes are nearly a bell.
Points seen(const Points& pattern, double blur_px) {
  Points out = blurred_both_ways(pattern, kFine);
  const int width = static_cast<int>(std::lround(2.0 * blur_px * kFine));
  for (int i = 0; i < 3 && width > 1; ++i) out = blurred_both_ways(out, width);
  return out;
}

/// The pixels, moved by parts of one.
std::shared_ptr<Image> sampled(const Points& fine, int dx, int dy) {
  auto out = std::make_shared<Image>(Image{kPixels, kPixels, 1, {}});
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      out->values.push_back(fine(kFine / 2 + y * kFine + dy, kFine / 2 + x * kFine + dx));
  return out;
}

constexpr int kRim = 6;

/// Mean square of interpolated less photographed, over all parts of a pixel.
double error_of_lookup(const Points& fine) {
  const SplineImage spline(sampled(fine, 0, 0));
  double sum = 0.0, count = 0.0;
  for (int dy = 0; dy < kFine; ++dy)
    for (int dx = 0; dx < kFine; ++dx) {
      const auto photo = sampled(fine, dx, dy);
      for (int y = kRim; y < kPixels - kRim; ++y)
        for (int x = kRim; x < kPixels - kRim; ++x) {
          const Eigen::Vector2d at(x + double(dx) / kFine, y + double(dy) / kFine);
          sum += std::pow(spline.at(at).value - photo->at(x, y), 2), count += 1.0;
        }
    }
  return sum / count;
}

double mean(const Image& image) {
  double sum = 0.0;
  for (int y = kRim; y < kPixels - kRim; ++y)
    for (int x = kRim; x < kPixels - kRim; ++x) sum += image.at(x, y);
  return sum / std::pow(kPixels - 2 * kRim, 2);
}

Image level(float value) {
  return {kPixels, kPixels, 1, std::vector<float>(size_t{kPixels} * kPixels, value)};
}

TEST(Unresolved, IsTheErrorOfALookup) {
  for (const double radius : {1.5, 2.5, 4.0})
    for (const double flat : {1.0, 0.5}) {
      const Points fine = seen(dots(radius, flat), 0.0);
      const double told = mean(unresolved_variance(*sampled(fine, 0, 0), level(0.0f)));
      const double real = error_of_lookup(fine);
      EXPECT_GT(real, 1e-4) << radius << ' ' << flat;
      EXPECT_GT(real / told, 0.5) << radius << ' ' << flat;
      EXPECT_LT(real / told, 1.7) << radius << ' ' << flat;
    }
}

TEST(Unresolved, IsLittleBehindALensThatBlurs) {
  const Points fine = seen(dots(2.5, 1.0), 0.6);
  const double told = mean(unresolved_variance(*sampled(fine, 0, 0), level(0.0f)));
  EXPECT_LT(told, std::pow(0.015, 2));
  EXPECT_GT(told, error_of_lookup(fine));
}

/// Brightness that changes slowly, and the sensor's noise.
TEST(Unresolved, IsNotNoise) {
  Image image = level(0.0f);
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      image.at(x, y) = static_cast<float>(0.5 + 0.3 * std::sin(0.4 * x) * std::cos(0.5 * y));
  EXPECT_LT(mean(unresolved_variance(image, level(0.0f))), 1e-7);
  std::mt19937 draw(1);
  std::normal_distribution<float> noise(0.0f, 0.02f);
  for (float& value : image.values) value += noise(draw);
  // a mean of few values lies above none as often as below
  EXPECT_LT(mean(unresolved_variance(image, level(0.02f))), 0.08 * 0.02 * 0.02);
  EXPECT_GT(mean(unresolved_variance(image, level(0.01f))), 0.2 * 0.02 * 0.02);
}

}  // namespace
}  // namespace hookeye
