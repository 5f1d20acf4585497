// A small body before cameras that a fit may read in part: two of 400 x 520 px.
#pragma once

#include <memory>

#include "tests/estimation/small_capture.h"

namespace hookeye::test {

inline const char* kLargePhotos = R"(hookeye_recipe: 1
seed: 5
title: large photos
body:
  shape: block
  size: [20, 16, 34]
  bumps: 0.05
  facet: 7
  mesh: {edge: 8}
  density: 1.07e-9
  texture: {texel: 0.12, speckle: 1.4}
material:
  law: neo-hookean
  true: {mu: 0.02, kappa_over_mu: 10}
  told: {mu: 0.017}
  fit: [mu]
cameras: {count: 2, size: [400, 520], distance: 8, focal: 1900}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  poke: {use: validate, force: [-0.008, 0.01, 0.12]}
truth: {edge_factor: 1, rays_per_axis: 3, visibility_rays: 64}
)";

/// One for all tests that leave its files alone.
inline const SmallScene& large_photos() {
  static const SmallScene scene({.recipe = kLargePhotos});
  return scene;
}

/// The same capture with photos read in part (FitLimits::pixels, pixels_keep).
inline std::shared_ptr<const Scene> read_with(double pixels, double keep,
                                              const SmallScene& of = large_photos()) {
  Limits limits;
  limits.fit.pixels = pixels;
  limits.fit.pixels_keep = keep;
  return load_scene(read_capture(of.scene->capture.file), true, limits);
}

}  // namespace hookeye::test
