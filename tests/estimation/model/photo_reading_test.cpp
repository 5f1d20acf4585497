// Photos of many pixels: halved as long as that keeps what they tell, then in part of their tiles.
#include "estimation/model/photo_reading.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "estimation/evaluation/evaluation.h"
#include "tests/estimation/large_photos.h"

namespace hookeye::test {
namespace {

/// Speckle of so many pixels from bright to bright, with noise.
Photo speckled(double period) {
  constexpr int kWide = 128;
  constexpr float kNoise = 0.01f;
  Photo photo;
  Image I{kWide, kWide, 1, std::vector<float>(size_t(kWide) * kWide)};
  std::mt19937 engine(3);
  std::normal_distribution<float> noise(0.0f, kNoise);
  for (int y = 0; y < kWide; ++y)
    for (int x = 0; x < kWide; ++x)
      I.at(x, y) = static_cast<float>(0.4 + 0.2 * std::sin(2 * M_PI * x / period) *
                                                std::cos(2 * M_PI * y / period)) +
                   noise(engine);
  photo.valid = std::vector<unsigned char>(I.pixels(), 1);
  photo.sigma = {Image{kWide, kWide, 1, std::vector<float>(I.pixels(), kNoise)}};
  photo.planes = {I};
  return photo;
}

double kept(const Photo& photo, int halvings) {
  return told_of_motion(photo, 0, halvings) / told_of_motion(photo, 0, 0);
}

TEST(PhotoReading, HalvingKeepsWhatCoarseSpeckleTellsAndNotWhatFineDoes) {
  // The mean of two pixels leaves cos(pi/period) of a pattern's amplitude, along both axes.
  const Photo coarse = speckled(16.0), fine = speckled(5.0);
  // The border has no slope, and differences over larger pixels are a little short.
  const double amplitude2 = std::pow(std::cos(M_PI / 16.0), 4);
  EXPECT_LT(kept(coarse, 1), amplitude2);
  EXPECT_GT(kept(coarse, 1), 0.88 * amplitude2);
  EXPECT_LT(kept(fine, 1), std::pow(std::cos(M_PI / 5.0), 4) + 0.05);
  EXPECT_LT(kept(fine, 2), 0.1);
}

TEST(PhotoReading, NoiseTellsNothing) {
  Photo blank = speckled(16.0);
  std::mt19937 engine(4);
  std::normal_distribution<float> noise(0.4f, 0.01f);
  for (float& value : blank.planes[0].own().values) value = noise(engine);
  EXPECT_LT(told_of_motion(blank, 0, 0), 0.02 * told_of_motion(speckled(16.0), 0, 0));
}

struct Found {
  double mu, half_width, chi, inner_chi;  ///< inner: of pixels with no background beside them
};

/// Sum of squares and count of residuals whose neighbours all show the body.
std::pair<double, double> inner(const PhotoEvaluation& photo) {
  std::pair<double, double> out{0.0, 0.0};
  const Image& I = photo.model;
  for (int y = 1; y + 1 < I.height; ++y)
    for (int x = 1; x + 1 < I.width; ++x) {
      const float r = photo.residual.at(x, y);
      bool beside = std::isnan(r);
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u) beside = beside || I.at(u, v) < 0.01f;
      if (!beside) out.first += double(r) * r, out.second += 1.0;
    }
  return out;
}

Found fitted(std::shared_ptr<const Scene> scene) {
  Workspace workspace(scene);
  const Fitted fit = base_fit(workspace);
  Found out{value_of(fit, "mu"), (fit.high[0] - fit.low[0]) / 2, fit.evaluation.chi(false), 0.0};
  double r2 = 0.0, count = 0.0;
  for (const auto& example : fit.evaluation.examples)
    for (const auto& photo : example.photos) {
      const auto [own_r2, own] = inner(photo);
      r2 += own_r2, count += own;
    }
  out.inner_chi = std::sqrt(r2 / count);
  return out;
}

TEST(PhotoReading, SmallPhotosAreReadWhole) {
  EXPECT_TRUE(large_photos().scene->readings.empty());
  EXPECT_TRUE(read_with(0.0, 0.5)->readings.empty());
}

TEST(PhotoReading, HalvedPhotosGiveTheSameModelAndFitItAsWell) {
  const auto scene = read_with(2e4, 0.3);
  ASSERT_EQ(scene->readings.size(), 2u);
  for (const auto& [camera, reading] : scene->readings) {
    EXPECT_GE(reading.halvings, 1);
    EXPECT_EQ(reading.share, 1.0);
    const Camera& seen = scene->capture.camera(camera);
    EXPECT_LE(seen.width, 400 >> reading.halvings);
    for (const Photo& photo : scene->photos[0]) {
      if (photo.camera != camera) continue;
      EXPECT_EQ(photo.planes[0]->width, seen.width);
    }
  }
  const Found whole = fitted(large_photos().scene), halved = fitted(scene);
  EXPECT_NEAR(whole.chi, 1.0, 0.05);
  // The filter of a halved pixel is that of its four. Of a body of some hundred pixels the rim is a
  // tenth, where four rays a side see less than the six of the truth.
  EXPECT_NEAR(halved.inner_chi, 1.0, 0.05);
  EXPECT_LT(halved.chi, 1.5);
  EXPECT_NEAR(halved.mu, whole.mu, 1e-4 * whole.mu);  // what the rim moves it by
  EXPECT_LT(halved.half_width, 2.5 * whole.half_width);
}

TEST(PhotoReading, TilesAreDrawnBesideTheSameModel) {
  const auto scene = read_with(2e4, 1.0);
  for (const auto& [camera, reading] : scene->readings) {
    EXPECT_EQ(reading.halvings, 0);
    EXPECT_LT(reading.share, 0.7);
    const auto& valid = *scene->photos[0][0].valid;
    const double share = std::accumulate(valid.begin(), valid.end(), 0.0) / double(valid.size());
    EXPECT_NEAR(share, reading.share, 0.3);  // some 30 tiles
  }
  const Found whole = fitted(large_photos().scene), part = fitted(scene);
  EXPECT_NEAR(part.chi, whole.chi, 0.05);
  EXPECT_NEAR(part.mu, whole.mu, 1.5 * part.half_width);
  EXPECT_GT(part.half_width, whole.half_width);
}

/// A black frame with a square that is brighter by so much, from (x, y).
Photo square(int x0, int y0, float brighter) {
  constexpr int kWide = 400, kSquare = 40;
  Photo photo;
  Image I{kWide, kWide, 1, std::vector<float>(size_t(kWide) * kWide, 0.1f)};
  std::mt19937 engine(static_cast<unsigned>(x0));
  std::normal_distribution<float> noise(0.0f, 0.01f);
  for (int y = y0; y < y0 + kSquare; ++y)
    for (int x = x0; x < x0 + kSquare; ++x) I.at(x, y) += brighter;
  for (float& value : I.values) value += noise(engine);
  photo.valid = std::vector<unsigned char>(I.pixels(), 1);
  photo.sigma = {Image{kWide, kWide, 1, std::vector<float>(I.pixels(), 0.01f)}};
  photo.planes = {I};
  return photo;
}

TEST(PhotoReading, TheWindowHoldsWhatMovesAndNothingElse) {
  const PhotoWindow moved = changed_between(square(100, 200, 0.3f), square(130, 210, 0.3f));
  EXPECT_NEAR(moved.x, 100, 8);
  EXPECT_NEAR(moved.y, 200, 8);
  EXPECT_NEAR(moved.x + moved.width, 170, 8);
  EXPECT_NEAR(moved.y + moved.height, 250, 8);
  EXPECT_TRUE(changed_between(square(100, 200, 0.0f), square(130, 210, 0.0f)).empty()) << "noise";
  const PhotoWindow room = with_margin(moved, 400, 400);
  EXPECT_LE(room.x, moved.x - 16);
  EXPECT_GE(room.x + room.width, moved.x + moved.width + 16);
  EXPECT_EQ(room.x % 16, 0);
  EXPECT_TRUE(with_margin({5, 5, 380, 380}, 400, 400).empty()) << "not worth a cut";
  // Coarse pictures need some pixels, wherever the window is.
  EXPECT_TRUE(with_margin({}, 4000, 3000).empty()) << "nothing to see";
  for (const PhotoWindow& small : {PhotoWindow{0, 0, 5, 5}, PhotoWindow{2000, 1000, 5, 5}}) {
    EXPECT_GE(with_margin(small, 4000, 3000).width, 128);
    EXPECT_GE(with_margin(small, 4000, 3000).height, 128);
  }
  EXPECT_TRUE(with_margin({3990, 100, 5, 5}, 4000, 3000).empty()) << "at the far border";
}

/// A point of the body stands where it stood in the whole photo.
TEST(PhotoReading, CameraAndPhotoAreCutAlike) {
  const auto scene = read_with(2e4, 0.3);
  const Capture whole = read_capture(large_photos().scene->capture.file);
  const Photo full = read_photo(whole.examples[0].photos[0], whole.cameras[0]);
  const PhotoReading reading = scene->readings.at(whole.cameras[0].name);
  ASSERT_FALSE(reading.window.empty());
  PhotoReading uncut = reading;
  uncut.window = {};
  const Photo halved_photo = as_read(full, uncut, "");
  const Photo& cut = scene->photos[0][0];
  const Eigen::Vector3d X = scene->body->surface.mesh.X.col(0);
  const Eigen::Vector2d there = as_read(whole.cameras[0], uncut).project(X);
  const Eigen::Vector2d here = scene->capture.camera(cut.camera).project(X);
  EXPECT_NEAR(there.x() - here.x(), reading.window.x, 1e-9);
  EXPECT_NEAR(there.y() - here.y(), reading.window.y, 1e-9);
  for (const int at : {0, 7, 20})
    EXPECT_EQ(cut.planes[0]->at(at, at),
              halved_photo.planes[0]->at(at + reading.window.x, at + reading.window.y));
}

TEST(PhotoReading, MemoryIsKeptByHalvingFurther) {
  const Capture capture = read_capture(large_photos().scene->capture.file);
  const SurfaceMesh& surface = large_photos().scene->body->surface.mesh;
  const auto read_within = [&](double bytes) {
    return within_memory({}, capture.cameras[0], surface, 100.0, 1.0, bytes);
  };
  EXPECT_TRUE(read_within(1e9).whole());
  const PhotoReading once = read_within(5e7);  // 12 bytes a pixel, of 100 photos
  EXPECT_EQ(once.halvings, 1);
  EXPECT_TRUE(once.for_memory);
  EXPECT_THAT(described("left", once), ::testing::HasSubstr("--memory"));
  EXPECT_GT(read_within(1e7).halvings, once.halvings);
}

TEST(PhotoReading, TheDrawIsThePhotosOwn) {
  const auto scene = read_with(2e4, 1.0);
  Limits limits;
  limits.fit.pixels = 2e4;
  limits.fit.pixels_keep = 1.0;
  Capture turned = read_capture(large_photos().scene->capture.file);
  std::reverse(turned.examples.begin(), turned.examples.end());
  std::reverse(turned.cameras.begin(), turned.cameras.end());
  const auto other = load_scene(turned, true, limits);
  EXPECT_EQ(*scene->photos[0][0].valid, *other->photos[turned.examples.size() - 1][0].valid);
  EXPECT_NE(*scene->photos[0][0].valid, *scene->photos[1][0].valid);
}

}  // namespace
}  // namespace hookeye::test
