// Noise of photos that texture fills: of known law, under speckle of all sizes, sharp and soft.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "capture_io/capture.h"
#include "capture_io/capture_folder.h"

namespace hookeye::test {
namespace {

struct Speckle {
  double diameter;  ///< [px]
  double soft;      ///< width of a speckle's rim over its radius
};

/// Dark discs over half a bright ground, each pixel the mean of 3 x 3 rays.
Image speckled(int side, const Speckle& speckle, const NoiseModel& law, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  const int fine = 3 * side;
  std::vector<float> rays(static_cast<size_t>(fine) * fine, 0.75f);
  const double mean_area = 0.7854 * std::pow(3 * speckle.diameter, 2);
  const int discs = static_cast<int>(0.8 * fine * fine / mean_area);  // covers 0.55
  for (int d = 0; d < discs; ++d) {
    const double x0 = uniform(random) * fine, y0 = uniform(random) * fine,
                 r = 1.5 * speckle.diameter * (0.6 + 0.75 * uniform(random)),
                 grey = 0.2 + 0.15 * uniform(random), rim = std::max(speckle.soft * r, 1e-9);
    for (int y = std::max(0, int(y0 - 2 * r)); y < std::min<double>(fine, y0 + 2 * r); ++y)
      for (int x = std::max(0, int(x0 - 2 * r)); x < std::min<double>(fine, x0 + 2 * r); ++x) {
        const double in = std::clamp((r - std::hypot(x - x0, y - y0)) / rim + 0.5, 0.0, 1.0);
        float& ray = rays[static_cast<size_t>(y) * fine + x];
        ray = static_cast<float>(ray * (1 - in) + grey * in);
      }
  }
  std::normal_distribution<double> normal;
  Image image{side, side, 1, std::vector<float>(static_cast<size_t>(side) * side)};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      double sum = 0;
      for (int k = 0; k < 9; ++k)
        sum += rays[static_cast<size_t>(3 * y + k / 3) * fine + 3 * x + k % 3];
      image.at(x, y) = static_cast<float>(sum / 9 + law.sigma(sum / 9) * normal(random));
    }
  return image;
}

/// Sharp speckle of three pixels had passed for 12 to 28 times the noise, of eight for 6 to 15.
TEST(SpeckleNoiseTest, SpeckleEverywhereIsNotTakenForNoise) {
  for (const NoiseModel& law : {NoiseModel{20000, 0.0011}, NoiseModel{2000, 0.004},
                                NoiseModel{0, 0.002}, NoiseModel{0, 0.01}})
    for (const int side : {120, 240, 360})
      for (const Speckle& speckle : {Speckle{3, 0}, Speckle{5, 0}, Speckle{8, 0}, Speckle{14, 0},
                                     Speckle{3, 0.5}, Speckle{5, 0.5}, Speckle{8, 0.5}}) {
        const NoiseModel found = estimate_noise(speckled(side, speckle, law, 5));
        for (const double intensity : {0.25, 0.45, 0.7}) {
          const double factor = found.sigma(intensity) / law.sigma(intensity);
          EXPECT_GT(factor, 0.5) << side << " px, speckle " << speckle.diameter << " px, soft "
                                 << speckle.soft << ", read " << law.read << ", at " << intensity;
          EXPECT_LT(factor, 2.2) << side << " px, speckle " << speckle.diameter << " px, soft "
                                 << speckle.soft << ", read " << law.read << ", at " << intensity;
        }
      }
}

/// Where the photo cannot tell, that is told.
TEST(SpeckleNoiseTest, DoubtIsTold) {
  const NoiseModel law{0, 0.002};
  EXPECT_TRUE(estimate_noise(speckled(60, {3, 0}, law, 5)).doubtful) << "small";
  EXPECT_TRUE(estimate_noise(speckled(240, {3, 0}, law, 5)).doubtful) << "texture everywhere";
  Image plain{240, 240, 1, std::vector<float>(57600)};
  std::mt19937 random(3);
  std::normal_distribution<float> normal(0.5f, 0.01f);
  for (float& value : plain.values) value = normal(random);
  EXPECT_FALSE(estimate_noise(plain).doubtful);
  EXPECT_TRUE(estimate_noise(plain, false).doubtful) << "correlated between pixels";
}

TEST(SpeckleNoiseTest, ToldNoiseIsNotDoubted) {
  const TemporaryFolder folder;
  PhotoSpec spec;
  spec.file = folder / "a.png";
  write_image(spec.file, speckled(60, {3, 0}, {0, 0.01}, 5));
  Camera camera;
  camera.width = camera.height = 60;
  EXPECT_TRUE(read_photo(spec, camera).noise.doubtful);
  spec.noise = NoiseModel{0, 0.002};
  EXPECT_FALSE(read_photo(spec, camera).noise.doubtful);
}

}  // namespace
}  // namespace hookeye::test
