// What lenses do to brightness and colour is found beside the material.
#include <gtest/gtest.h>

#include <random>

#include "estimation/evaluation/photo_evaluation.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

/// A wide lens near the body, so that there is an angle to the axis.
std::string recipe(const std::string& told_mu, const std::string& lens) {
  return R"(hookeye_recipe: 1
seed: 8
title: block by a wide lens
body:
  shape: block
  size: [20, 16, 30]
  taper: 0.85
  mesh: {edge: 8}
  density: 1.07e-9
  texture: {texel: 0.12, speckle: 1.4}
material:
  law: neo-hookean
  true: {mu: 0.02, kappa_over_mu: 10}
  told: {mu: )" +
         told_mu + R"(}
  fit: [mu]
cameras: {count: 2, size: [160, 200], distance: 2.2, focal: 300, azimuth: -40, spread: 80, elevation: 20)" +
         lens + R"(}
light: {ambient: 0.4, toward: [-0.3, -0.8, 0.6], strength: 0.5}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.015, 0.01, 0]}
truth: {edge_factor: 1, rays_per_axis: 3, visibility_rays: 64}
)";
}

double value_of(const Fitted& fitted, const std::string& name) {
  const auto parameters = fitted.form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == name) return fitted.p[static_cast<Eigen::Index>(i)];
  ADD_FAILURE() << "no parameter " << name;
  return std::nan("");
}

/// The scene with each camera changed.
template <class Change>
std::shared_ptr<const Scene> with_cameras(const Scene& scene, const Change& change) {
  auto out = std::make_shared<Scene>(scene);
  for (Camera& camera : out->capture.cameras) change(camera);
  return out;
}

TEST(Lenses, VignettingIsFoundWithTheMaterial) {
  const test::SmallScene small({.recipe = recipe("0.024", ", vignetting: 1.4")});
  ASSERT_EQ(small.scene->capture.cameras[1].vignetting, 1.4);
  Workspace untold(with_cameras(*small.scene, [](Camera& camera) { camera.vignetting = 0.0; }));
  const double without = test::base_fit(untold).evaluation.chi(false);
  Workspace opened(with_cameras(*small.scene, [](Camera& camera) {
    camera.vignetting = 0.0;
    camera.fit_vignetting = true;
  }));
  const Fitted fitted = test::base_fit(opened);
  EXPECT_LT(fitted.evaluation.chi(false), 1.05);
  EXPECT_GT(without, 1.5);
  EXPECT_NEAR(value_of(fitted, "vignetting.cam0"), 1.4, 0.05);
  EXPECT_NEAR(value_of(fitted, "vignetting.cam1"), 1.4, 0.05);
  EXPECT_NEAR(value_of(fitted, "mu"), 0.02, 2e-4);
}

/// The same load cases in three colours, whose pictures differ in size.
std::shared_ptr<const Scene> in_colours(const Scene& grey, const Eigen::Vector2d& zoom) {
  auto out = std::make_shared<Scene>(grey);
  for (size_t e = 0; e < out->photos.size(); ++e)
    for (size_t k = 0; k < out->photos[e].size(); ++k) {
      out->capture.examples[e].photos[k].rgb = true;
      Photo& photo = out->photos[e][k];
      photo.planes.resize(3, photo.planes[0]);
      photo.sigma.resize(3, photo.sigma[0]);
      photo.channel_weights = {1, 1, 1};
    }
  for (Camera& camera : out->capture.cameras) camera.colour_zoom = zoom;
  const ModelForm form = base_form(out);
  Workspace workspace(out);
  EvaluationOptions look;
  look.derivatives = false;
  look.held_out = true;
  const Evaluation states = workspace.evaluate(form, form.initial(), look).value();
  RenderOptions options = render_options(*out);
  options.derivatives = false;
  auto seen = std::make_shared<Scene>(*out);
  std::mt19937 draw(3);
  const Model model = form.realise(form.initial());
  for (const ExampleEvaluation& state : states.examples) {
    PhotoComparer comparer(out, state.example);
    auto& photos = seen->photos[static_cast<size_t>(state.example)];
    for (size_t k = 0; k < photos.size(); ++k)
      for (int plane = 0; plane < 3; ++plane) {
        Image I =
            comparer
                .render(model, state.equilibrium->q, nullptr, static_cast<int>(k), plane, options)
                .I;
        Image sigma = I;
        for (size_t i = 0; i < I.values.size(); ++i) {
          const double noise = photos[k].noise.sigma(I.values[i]);
          sigma.values[i] = static_cast<float>(noise);
          I.values[i] += static_cast<float>(std::normal_distribution(0.0, noise)(draw));
        }
        photos[k].planes[plane] = I;
        photos[k].sigma[plane] = sigma;
      }
  }
  return seen;
}

TEST(Lenses, SizesOfColoursAreFound) {
  const test::SmallScene small({.recipe = recipe("0.02", "")});
  const Eigen::Vector2d truth(1.5e-3, -0.8e-3);  // 0.2 px in the corners
  const auto colours = in_colours(*small.scene, truth);
  Workspace told(colours);
  EXPECT_LT(test::base_fit(told).evaluation.chi(false), 1.05);
  Workspace opened(with_cameras(*colours, [](Camera& camera) {
    camera.colour_zoom.setZero();
    camera.fit_colour_zoom = true;
  }));
  const Fitted fitted = test::base_fit(opened);
  EXPECT_LT(fitted.evaluation.chi(false), 1.05);
  for (const char* camera : {"cam0", "cam1"}) {
    EXPECT_NEAR(value_of(fitted, std::string("red_shift.") + camera), truth[0], 3e-5);
    EXPECT_NEAR(value_of(fitted, std::string("blue_shift.") + camera), truth[1], 3e-5);
  }
  Workspace blind(with_cameras(*colours, [](Camera& camera) { camera.colour_zoom.setZero(); }));
  EXPECT_GT(test::base_fit(blind).evaluation.chi(false), 1.3);
}

}  // namespace
}  // namespace hookeye
