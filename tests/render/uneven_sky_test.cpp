// Bodies under a sky of harmonics: what they mean, that they turn, and that they end at zero.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "render/renderer.h"
#include "scene.h"

namespace hookeye {
namespace {

class UnevenSky : public testing::Test {
 protected:
  UnevenSky() : surface(test::sphere(Vector3d::Zero(), 8, 2, 0.1)), renderer(surface) {
    state = test::state(test::camera("perspective", false));
    state.sun.setZero();
    state.specular = 0;
    state.ambient = 0.6;
    state.uneven << 0.3, -0.2, 0.25, 0.3, -0.2, 0.2, -0.15, 0.3;
    texture.albedo = 0.8;
    options.derivatives = false;
  }
  Rendering render(const PhotoState& photo) {
    return renderer.render(surface.X, nullptr, texture, photo, options, true);
  }

  SurfaceMesh surface;
  Renderer renderer;
  PhotoState state;
  Texture texture;
  RenderOptions options;
};

double largest_difference(const Image& a, const Image& b) {
  double out = 0;
  for (size_t i = 0; i < a.values.size(); ++i)
    out = std::max(out, std::abs(double(a.values[i]) - b.values[i]));
  return out;
}

/// A light of second order reaches matt facets as the sum of suns that have its radiance.
TEST_F(UnevenSky, IsTheSumOfItsDirections) {
  options.smooth_normals = options.cast_shadows = false;
  options.visibility_rays = 0;
  state.background = 0;
  const Rendering sky = render(state);
  std::vector<double> sum(sky.I.values.size(), 0.0);
  constexpr int kSuns = 400;
  const UnevenLight& L = state.uneven;
  double darkest = 1;
  for (int i = 0; i < kSuns; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kSuns, a = i * M_PI * (3.0 - std::sqrt(5.0));
    const double x = std::sqrt(1.0 - z * z) * std::cos(a), y = std::sqrt(1.0 - z * z) * std::sin(a);
    const double radiance = state.ambient + 0.488603 * (L[0] * y + L[1] * z + L[2] * x) +
                            1.092548 * (L[3] * x * y + L[4] * y * z + L[6] * x * z) +
                            0.315392 * L[5] * (3 * z * z - 1) + 0.546274 * L[7] * (x * x - y * y);
    darkest = std::min(darkest, radiance);
    PhotoState sun = state;
    sun.ambient = 0;
    sun.uneven.setZero();
    sun.sun = 4 * radiance / kSuns * Vector3d(x, y, z);
    const Rendering one = render(sun);
    for (size_t k = 0; k < sum.size(); ++k) sum[k] += one.I.values[k];
  }
  ASSERT_GT(darkest, 0) << "no sun is darker than nothing";
  double brightest = 0, least = 1, off = 0;
  for (size_t k = 0; k < sum.size(); ++k) {
    if (sky.coverage.values[k] < 1) continue;
    brightest = std::max(brightest, sum[k]), least = std::min(least, sum[k]);
    off = std::max(off, std::abs(sum[k] - sky.I.values[k]));
  }
  EXPECT_GT(brightest, 1.5 * least) << "the light is too even to tell anything";
  EXPECT_LT(off, 0.01 * brightest);
}

TEST_F(UnevenSky, TurnsWithBodyAndCamera) {
  state.sun = Vector3d(0.2, -0.3, 0.1);
  const Rendering first = render(state);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Vector3d(0.4, -0.7, 0.2).normalized()).toRotationMatrix();
  surface.X = (R * surface.X).eval();
  PhotoState with = state;
  with.camera.R = state.camera.R * R.transpose();
  with.sun = R * state.sun;
  const double lost = largest_difference(render(with).I, first.I);
  with.uneven = turned(state.uneven, R);
  const double kept = largest_difference(render(with).I, first.I);
  EXPECT_GT(lost, 0.05);
  EXPECT_LT(kept, 1e-3 * lost);
}

/// A lamp's harmonics fall below zero on its far side: there it is dark, and stays so.
TEST_F(UnevenSky, EndsAtZero) {
  options.derivatives = true;
  state.ambient = 0.1;
  state.uneven << 0, 0, 1.0, 0, 0, 0, 0, 0;
  state.background = 0.5;
  const Rendering seen = render(state);
  const test::Joined dI = test::joined(seen.dI);
  int black = 0, lit = 0;
  for (size_t i = 0; i < dI.pixel.size(); ++i) {
    if (seen.coverage.values[dI.pixel[i]] < 1) continue;
    const double I = seen.I.values[dI.pixel[i]];
    ASSERT_GE(I, 0);
    const double slope = dI.d_photo.col(Eigen::Index(i)).tail<kUnevenNumbers>().norm();
    if (I > 0) {
      EXPECT_GT(slope, 0);
      ++lit;
    } else {
      EXPECT_EQ(slope, 0);
      ++black;
    }
  }
  EXPECT_GT(black, 100);
  EXPECT_GT(lit, 100);
}

}  // namespace
}  // namespace hookeye
