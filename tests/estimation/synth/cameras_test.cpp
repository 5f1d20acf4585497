// A whole fit from photos of a fisheye near the body and of a telecentric camera.
#include <gmock/gmock.h>

#include "core/input_error.h"
#include "estimation/synth/synth.h"
#include "tests/estimation/small_capture.h"

namespace hookeye::test {
namespace {

const char* const kRecipe = R"(hookeye_recipe: 1
seed: 7
title: small block before two cameras
body:
  shape: block
  size: [20, 16, 34]
  bumps: 0.05
  facet: 7
  mesh: {edge: 8}
  texture: {texel: 0.12, speckle: 1.4}
material:
  law: neo-hookean
  true: {mu: 0.02, kappa_over_mu: 10}
  told: {mu: 0.025}
  fit: [mu]
cameras:
  {count: 2, size: [200, 260], distance: 1.6, focal: 210, projection: [fisheye, orthographic],
   distortion: [-0.06, 0.02, -0.005, 0]}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.012, 0.006, 0]}
truth: {edge_factor: 1, rays_per_axis: 3, visibility_rays: 64}
)";

TEST(CameraModels, AFitRecoversTheStiffness) {
  SmallCapture capture;
  capture.recipe = kRecipe;
  const SmallScene small(capture);
  ASSERT_EQ(small.scene->capture.camera("cam0").model->name(), "fisheye");
  EXPECT_EQ(small.scene->capture.camera("cam0").distortion.size(), 4u);
  ASSERT_EQ(small.scene->capture.camera("cam1").model->name(), "orthographic");
  Workspace workspace(small.scene);
  const Fitted fitted = base_fit(workspace);
  ASSERT_EQ(fitted.form.parameters().front().name, "mu");
  EXPECT_NEAR(fitted.p[0], 0.02, 2e-4);
  EXPECT_LE(fitted.low[0], 0.02);
  EXPECT_GE(fitted.high[0], 0.02);
  EXPECT_LT(fitted.high[0] - fitted.low[0], 4e-4);
  EXPECT_NEAR(fitted.evaluation.chi(false), 1, 0.05);
}

/// What a recipe tells of its cameras, and what is said where it cannot be.
TEST(CameraModels, RecipesNameThem) {
  const auto refused = [](const std::string& cameras) {
    std::string text = kRecipe;
    const size_t begin = text.find("cameras:"), end = text.find("examples:");
    text.replace(begin, end - begin, "cameras: {count: 2, focal: 210, " + cameras + "}\n");
    try {
      parse_recipe(text, "recipe.yaml");
    } catch (const InputError& error) {
      return error.wrong();
    }
    return std::string();
  };
  EXPECT_EQ(refused("projection: fisheye"), "");
  EXPECT_EQ(refused("projection: [fisheye, perspective], distortion: [0.1, 0, 0, 0]"), "");
  EXPECT_EQ(refused("projection: cylindrical"), "projection of cameras is `cylindrical`");
  EXPECT_EQ(refused("projection: [fisheye]"), "2 cameras have 1 projections");
  EXPECT_EQ(refused("projection: fisheye, distortion: [0.1, 0, 0, 0, 0]"),
            "distortion of fisheye cameras has 5 numbers");
}

}  // namespace
}  // namespace hookeye::test
