// The model's picture takes the photo's brightness, patch by patch.
#include "estimation/images/brightness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace hookeye {
namespace {

/// A sheet of two squares in the plane z = 0, the right one bent up by `degrees`.
SurfaceMesh two_squares(double degrees) {
  const double a = degrees * M_PI / 180.0;
  SurfaceMesh out;
  out.X.resize(3, 6);
  out.X << 0, 1, 0, 1, 1 + std::cos(a), 1 + std::cos(a),  //
      0, 0, 1, 1, 0, 1,                                   //
      0, 0, 0, 0, std::sin(a), std::sin(a);
  out.triangles = {{0, 1, 3}, {0, 3, 2}, {1, 4, 5}, {1, 5, 3}};
  return out;
}

TEST(SmoothPatches, PartAtSharpEdges) {
  EXPECT_THAT(smooth_patches(two_squares(20.0), 30.0), testing::ElementsAre(0, 0, 0, 0));
  const auto bent = smooth_patches(two_squares(40.0), 30.0);
  EXPECT_EQ(bent[0], bent[1]);
  EXPECT_EQ(bent[2], bent[3]);
  EXPECT_NE(bent[0], bent[2]);
}

constexpr int kWide = 90, kHigh = 70;

/// Speckles over two patches that part at x = 41; no body beyond a margin.
struct Pictures {
  Rendering model;
  Image photo{kWide, kHigh, 1, std::vector<float>(kWide* kHigh)};
  std::vector<int> patches = {0, 1};

  explicit Pictures(const std::function<double(int, int)>& gain) {
    std::mt19937 engine(3);
    std::uniform_real_distribution<float> level(0.2f, 0.8f);
    model.I = model.coverage = photo;
    model.triangle.assign(photo.pixels(), -1);
    for (int y = 0; y < kHigh; ++y)
      for (int x = 0; x < kWide; ++x) {
        const bool body = x > 4 && x < kWide - 6 && y > 3 && y < kHigh - 2;
        model.I.at(x, y) = level(engine);
        model.coverage.at(x, y) = body ? 1.0f : 0.4f;
        if (body) model.triangle[y * kWide + x] = x < 41 ? 0 : 1;
        photo.at(x, y) = static_cast<float>(gain(x, y) * model.I.at(x, y));
      }
  }
  Brightness brightness() const { return {model, photo, {}, patches, 16.0}; }
};

TEST(Brightness, EachPatchHasItsOwn) {
  const Pictures pictures([](int x, int) { return x < 41 ? 0.7 : 1.3; });
  const Brightness brightness = pictures.brightness();
  const Image followed = brightness.followed();
  for (int y = 20; y < 50; ++y)
    for (int x = 20; x < 70; ++x)
      EXPECT_NEAR(brightness.gain(y * kWide + x), x < 41 ? 0.7 : 1.3, 0.01) << x << " " << y;
  EXPECT_EQ(followed.at(2, 30), pictures.model.I.at(2, 30)) << "nothing follows beside the body";
  EXPECT_FALSE(brightness.follows(30 * kWide + 2));
}

TEST(Brightness, NothingFollowsADarkPhotoOrNone) {
  const Pictures dark([](int, int) { return 0.0; });
  EXPECT_EQ(dark.brightness().followed().values, dark.model.I.values);
  Pictures none([](int, int) { return 1.0; });
  none.model.triangle.assign(none.photo.pixels(), -1);
  EXPECT_EQ(none.brightness().nodes(), 0);
}

/// <K d, v> = <d, K^T v>, K by finite differences.
TEST(Brightness, AdjointIsThatOfTheDerivative) {
  const Pictures at([](int x, int y) { return 0.8 + 0.004 * x - 0.002 * y; });
  std::mt19937 engine(5);
  std::normal_distribution<float> normal;
  Image d = at.photo, v = at.photo;
  for (float& value : d.values) value = normal(engine);
  for (float& value : v.values) value = 1.0f + normal(engine);
  const auto moved = [&](float h) {
    Pictures out = at;
    for (size_t i = 0; i < d.values.size(); ++i) out.model.I.values[i] += h * d.values[i];
    return out.brightness().followed();
  };
  const Image plus = moved(1e-2f), minus = moved(-1e-2f), back = at.brightness().adjoint(v);
  double left = 0.0, right = 0.0;
  for (size_t i = 0; i < d.values.size(); ++i) {
    left += (double(plus.values[i]) - minus.values[i]) / 2e-2 * v.values[i];
    right += double(d.values[i]) * back.values[i];
  }
  EXPECT_NEAR(left, right, 1e-3 * std::abs(right));
}

}  // namespace
}  // namespace hookeye
