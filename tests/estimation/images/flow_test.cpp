// The residual as a displacement: known motions come out, white noise stays white.
#include "estimation/images/flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "estimation/images/registration.h"
#include "tests/estimation/repeats.h"

namespace hookeye {
namespace {

constexpr int kWidth = 160, kHeight = 128;

/// A smooth speckle, moved by (u, v).
Image speckle(double u, double v) {
  Image image{kWidth, kHeight, 1, std::vector<float>(kWidth * kHeight)};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double X = x - u, Y = y - v;
      image.at(x, y) = static_cast<float>(0.5 + 0.15 * std::sin(0.55 * X + 0.21 * Y) +
                                          0.15 * std::cos(0.17 * X - 0.63 * Y) +
                                          0.1 * std::sin(0.09 * X * 1.7 + 0.05 * Y));
    }
  return image;
}

Image constant(float value) {
  return {kWidth, kHeight, 1, std::vector<float>(kWidth * kHeight, value)};
}

Image over_noise(const Image& model, const Image& photo, float sigma) {
  Image r = model;
  for (size_t i = 0; i < r.values.size(); ++i)
    r.values[i] = (model.values[i] - photo.values[i]) / sigma;
  return r;
}

/// Where the pictures differ in more than motion the search goes astray; what it finds there must
/// not enter as motion.
TEST(Registration, MotionThatLowersNoMisfitIsDropped) {
  const Image model = speckle(0.0, 0.0);
  Image photo = speckle(0.1, -0.05);
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> other(0.1f, 0.9f);
  for (int y = 40; y < 90; ++y)
    for (int x = 50; x < 110; ++x) photo.at(x, y) = other(engine);
  const Image sigma = constant(0.01f), plain = over_noise(model, photo, 0.01f);
  const Registration found = register_pictures(model, photo, plain, sigma);
  int kept = 0;
  for (int y0 = 0; y0 < kHeight; y0 += 16)
    for (int x0 = 0; x0 < kWidth; x0 += 16) {
      double before = 0.0, after = 0.0;
      for (int y = y0; y < y0 + 16; ++y)
        for (int x = x0; x < x0 + 16; ++x) {
          before += std::pow(plain.at(x, y), 2);
          after += std::pow(found.residual.at(x, y), 2);
        }
      EXPECT_LE(after, before) << x0 << ", " << y0;
      kept += after < 0.5 * before;
    }
  EXPECT_GT(kept, 20);  // the moved speckle is still aligned
}

TEST(Flow, FindsTheMotionThatTheModelLacks) {
  const Image model = speckle(0, 0), photo = speckle(0.2, -0.1), sigma = constant(0.01f);
  const FlowField flow = residual_flow(model, over_noise(model, photo, 0.01f), sigma);
  ASSERT_GT(flow.cells.size(), 50u);
  for (const auto& cell : flow.cells) {
    EXPECT_NEAR(cell.estimate.x(), 0.2, 0.03);
    EXPECT_NEAR(cell.estimate.y(), -0.1, 0.03);
  }
  EXPECT_NEAR(flow.rms_px(), std::hypot(0.2, 0.1), 0.01);
}

TEST(Flow, WhiteNoiseIsWhite) {
  std::mt19937 engine(3);
  std::normal_distribution<float> normal;
  const Image model = speckle(0, 0);
  double variance = 0, effective = 0, count = 0;
  constexpr int kRepeats = 200;
  std::vector<double> p;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    Image r = constant(0);
    for (float& x : r.values) x = normal(engine);
    const FlowStatistics s = flow_statistics(residual_flow(model, r, constant(0.01f)));
    variance += s.variance / kRepeats;
    effective += s.effective / kRepeats;
    count += s.count / kRepeats;
    p.push_back(s.whiteness_p);
  }
  EXPECT_NEAR(variance, 1.0, 0.05);
  EXPECT_GT(effective, 0.9 * count);
  EXPECT_LE(test::excess_over_uniform(p), test::excess_95(kRepeats));
}

/// The picture bent: moved along x by an amount that changes sign from left to right.
Image bent(double amount) {
  Image image = speckle(0, 0);
  for (int x = 0; x < kWidth; ++x) {
    const Image moved = speckle(amount * std::cos(3.14159 * x / kWidth), 0);
    for (int y = 0; y < kHeight; ++y) image.at(x, y) = moved.at(x, y);
  }
  return image;
}

/// Cells that move against one another by one number tell as little as cells that move together,
/// and where the correlation of a ring of cells crosses zero is no matter of luck.
TEST(Flow, ABendIsOneObservationToo) {
  const Image model = speckle(0, 0);
  const auto effective = [&](double amount) {
    return flow_statistics(
        residual_flow(model, over_noise(model, bent(amount), 0.01f), constant(0.01f)));
  };
  const FlowStatistics s = effective(0.3);
  EXPECT_LT(s.effective, 0.1 * s.count);
  for (double amount : {0.2999, 0.3001, 0.302})
    EXPECT_NEAR(effective(amount).effective, s.effective, 0.02 * s.effective) << amount;
}

/// Stripes of cells that move against one another: the mean over a ring of neighbours is negative,
/// yet one number moves them all.
TEST(Flow, StripesAreOneObservationToo) {
  const Image model = speckle(0, 0), there = speckle(0.3, 0), back = speckle(-0.3, 0);
  Image photo = model;
  for (int x = 0; x < kWidth; ++x)
    for (int y = 0; y < kHeight; ++y) photo.at(x, y) = (x / 16 % 2 ? there : back).at(x, y);
  const FlowStatistics s =
      flow_statistics(residual_flow(model, over_noise(model, photo, 0.01f), constant(0.01f)));
  EXPECT_LT(s.effective, 0.1 * s.count);
}

/// Three channels with noise of their own are three photos; the same one three times is one.
TEST(Flow, ChannelsCountWhatTheyDoNotRepeat) {
  const Image model = speckle(0.0, 0.0);
  const auto field = [&](unsigned seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<float> noise;
    Image residual = constant(0.0f);
    for (float& r : residual.values) r = noise(engine);
    return residual_flow(model, residual, constant(0.01f));
  };
  const FlowField a = field(1), b = field(2), c = field(3);
  const FlowStatistics one = flow_statistics(a);
  for (const FlowStatistics& same : flow_statistics({&a, &a, &a})) {
    EXPECT_NEAR(same.inflation, 3.0 * one.inflation, 1e-9);
    EXPECT_NEAR(same.effective, one.effective / 3.0, 1e-9);
  }
  EXPECT_NEAR(flow_statistics({&a, &b, &c})[0].inflation, one.inflation, 0.2 * one.inflation);
  EXPECT_NEAR(flow_statistics({&a, &b, &c})[0].effective, one.effective, 0.2 * one.effective);
}

TEST(Flow, OneMotionEverywhereIsOneObservation) {
  const Image model = speckle(0, 0), photo = speckle(0.3, 0.3);
  const FlowStatistics s =
      flow_statistics(residual_flow(model, over_noise(model, photo, 0.01f), constant(0.01f)));
  EXPECT_GT(s.variance, 10.0);
  EXPECT_LT(s.effective, 0.1 * s.count);
  EXPECT_LT(s.whiteness_p, 1e-6);
}

TEST(Registration, MakesAMotionOfManyPixelsLinear) {
  const Image model = speckle(0, 0), photo = speckle(3.0, -2.0), sigma = constant(0.01f);
  const Image plain = over_noise(model, photo, 0.01f);
  const Registration registered = register_pictures(model, photo, plain, sigma);
  const FlowField flow = residual_flow(model, registered.linear, sigma);
  double u = 0, v = 0;
  for (const auto& cell : flow.cells) {
    u += cell.estimate.x() / flow.cells.size();
    v += cell.estimate.y() / flow.cells.size();
  }
  EXPECT_NEAR(u, 3.0, 0.3);
  EXPECT_NEAR(v, -2.0, 0.3);
}

/// A photo that is moved, brighter, less sharp and over a lighter background keeps its noise alone;
/// noise that was told too low shows.
TEST(Flow, WhatNoModelCouldRemoveIsTheNoise) {
  const float told = 0.01f;
  const Image model = speckle(0.0, 0.0), sigma = constant(told);
  for (const float noise : {0.01f, 0.02f}) {
    std::mt19937 engine(11);
    std::normal_distribution<float> normal(0.0f, noise);
    Image photo = speckle(0.12, -0.08);
    const Image sharp = photo;
    for (int y = 1; y + 1 < kHeight; ++y)
      for (int x = 1; x + 1 < kWidth; ++x) {
        const float around = sharp.at(x - 1, y) + sharp.at(x + 1, y) + sharp.at(x, y - 1) +
                             sharp.at(x, y + 1) - 4.0f * sharp.at(x, y);
        photo.at(x, y) += 0.1f * around;
      }
    for (float& value : photo.values) value = 1.03f * value + 0.02f + normal(engine);
    const Image residual = over_noise(model, photo, told);
    double plain = 0.0;
    for (const float r : residual.values) plain += r * r;
    const double truth = std::pow(noise / told, 2);
    EXPECT_GT(plain / static_cast<double>(residual.values.size()), 3.0 * truth);
    EXPECT_NEAR(variance_after_free_motion(model, residual, sigma) / truth, 1.0, 0.1);
  }
  EXPECT_EQ(variance_after_free_motion(model, constant(std::nanf("")), sigma), 1.0);
}

}  // namespace
}  // namespace hookeye
