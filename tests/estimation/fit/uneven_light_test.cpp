// Fits under light that is no sky and sun: by harmonics it is found, and the material with it.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "capture_io/light_harmonics.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/evaluation/photo_evaluation.h"
#include "support/derivative.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

/// A body whose normals point everywhere, seen from three sides.
std::string blob(const std::string& told_mu, const std::string& light) {
  return R"(hookeye_recipe: 1
seed: 5
title: blob
body:
  shape: blob
  size: [20, 18, 30]
  facet: 2.5
  mesh: {edge: 8}
  density: 1.07e-9
  texture: {texel: 0.12, speckle: 1.4}
material:
  law: neo-hookean
  true: {mu: 0.02, kappa_over_mu: 10}
  told: {mu: )" +
         told_mu + R"(}
  fit: [mu]
cameras: {count: 3, size: [160, 200], distance: 6, focal: 800, azimuth: -70, spread: 70, elevation: 20}
)" + light +
         R"(examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.015, 0.01, 0]}
truth: {edge_factor: 1, rays_per_axis: 3, visibility_rays: 64}
)";
}

test::SmallScene blob_scene(const std::string& told_mu, const std::string& light) {
  return test::SmallScene({.recipe = blob(told_mu, light)});
}

/// The scene with its light left open: sky and sun, or harmonics.
std::shared_ptr<const Scene> opened(const Scene& scene, bool harmonics) {
  auto out = std::make_shared<Scene>(scene);
  out->capture.light = LightSpec();
  out->capture.light.fit_harmonics = harmonics;
  return out;
}

/// Square lamps so far away that their light is parallel, each from four directions.
std::vector<Vector3d> two_lamps() {
  std::vector<Vector3d> out;
  for (const Vector3d& middle : {Vector3d(0.4, -0.9, 0.4), Vector3d(0.3, 0.9, 0.3)})
    for (const double i : {-1.0, 1.0})
      for (const double k : {-1.0, 1.0}) {
        const Vector3d side = middle.cross(Vector3d::UnitZ()).normalized();
        const Vector3d toward =
            middle.normalized() + 0.15 * (i * side + k * side.cross(middle.normalized()));
        out.push_back(0.09 * toward.normalized());
      }
  return out;
}
constexpr double kRoom = 0.15;  // what the walls send back

/// The same load cases photographed under the lamps and the room's light.
std::shared_ptr<const Scene> under_lamps(const std::shared_ptr<const Scene>& scene) {
  const ModelForm form = base_form(scene);
  Workspace workspace(scene);
  EvaluationOptions look;
  look.derivatives = false;
  look.held_out = true;
  const Evaluation states = workspace.evaluate(form, form.initial(), look).value();
  auto out = std::make_shared<Scene>(*scene);
  RenderOptions options = render_options(*scene);
  options.derivatives = false;
  std::mt19937 draw(3);
  for (const ExampleEvaluation& state : states.examples) {
    PhotoComparer comparer(scene, state.example);
    auto& photos = out->photos[static_cast<size_t>(state.example)];
    for (size_t k = 0; k < photos.size(); ++k) {
      const auto picture = [&](double ambient, const Vector3d& sun) {
        Model lit = form.realise(form.initial());
        PhotoState& photo = lit.examples[static_cast<size_t>(state.example)].photos[k];
        photo.ambient = ambient;
        photo.sun = sun;
        return comparer.render(lit, state.equilibrium->q, nullptr, static_cast<int>(k), 0, options)
            .I;
      };
      Image sum = picture(kRoom, Vector3d::Zero());
      for (const Vector3d& sun : two_lamps()) {
        const Image one = picture(0.0, sun);
        for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += one.values[i];
      }
      Image sigma = sum;
      for (size_t i = 0; i < sum.values.size(); ++i) {
        const double noise = photos[k].noise.sigma(sum.values[i]);
        sigma.values[i] = static_cast<float>(noise);
        sum.values[i] += static_cast<float>(std::normal_distribution(0.0, noise)(draw));
      }
      photos[k].planes[0] = sum;
      photos[k].sigma[0] = sigma;
    }
  }
  return out;
}

TEST(UnevenLight, IsFoundWithTheMaterial) {
  const UnevenLight truth{{-0.15, 0.3, 0.2, 0.1, -0.12, 0.08, 0.15, -0.1}};
  const test::SmallScene small = blob_scene(
      "0.024", "light: {harmonics: [1.6, -0.15, 0.3, 0.2, 0.1, -0.12, 0.08, 0.15, -0.1]}\n");
  ASSERT_TRUE(small.scene->capture.light.given);
  EXPECT_LT((small.scene->capture.light.uneven - truth).norm(), 1e-12);
  Workspace workspace(opened(*small.scene, true));
  const Fitted fitted = test::base_fit(workspace);
  EXPECT_LT(fitted.evaluation.chi(false), 1.02);
  const auto parameters = fitted.form.parameters();
  int found = 0;
  for (Eigen::Index i = 0; i < fitted.p.size(); ++i) {
    const std::string& name = parameters[i].name;
    double right = name == "mu" ? 0.02 : name == "light.L00" ? 1.6 : std::nan("");
    for (int k = 0; k < kUnevenNumbers; ++k)
      if (name == std::string("light.") + harmonic_names[k + 1]) right = truth[k];
    ASSERT_TRUE(std::isfinite(right)) << name;
    const double reach = fitted.high[i] - fitted.low[i];
    EXPECT_NEAR(fitted.p[i], right, reach) << name;
    EXPECT_LT(reach, name == "mu" ? 0.002 : 0.2) << name << ": these photos say little of it";
    ++found;
  }
  EXPECT_EQ(found, 10);
}

/// Light moves no rim: the slopes of the misfit are exact.
TEST(UnevenLight, HasTheMisfitsSlopes) {
  const test::SmallScene small = blob_scene("0.02", "");
  const auto scene = opened(*small.scene, true);
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto parameters = form.parameters();
  VectorXd p = form.initial();
  for (Eigen::Index i = 0; i < p.size(); ++i)
    if (parameters[i].name.starts_with("light.") && parameters[i].name != "light.L00")
      p[i] = i % 2 ? 0.1 : -0.07;
  const auto look = [&](const VectorXd& at, bool derivatives) {
    EvaluationOptions options;
    options.derivatives = derivatives;
    return normal_equations(workspace.evaluate(form, at, options).value());
  };
  const NormalEquations sums = look(p, true);
  int checked = 0;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    if (!parameters[i].name.starts_with("light.")) continue;
    test::expect_derivative(
        [&](double h) {
          return VectorXd::Constant(1, look(p + h * VectorXd::Unit(p.size(), i), false).r2);
        },
        VectorXd::Constant(1, 2.0 * sums.Jtr[i]), 0.01, 1e-3, parameters[i].name);
    ++checked;
  }
  EXPECT_EQ(checked, 9);
}

TEST(UnevenLight, OfTwoLampsIsNoSkyAndSun) {
  const test::SmallScene small = blob_scene("0.02", "");
  const auto lamps = under_lamps(small.scene);
  const auto left = [&](bool harmonics) {
    Workspace workspace(opened(*lamps, harmonics));
    return test::base_fit(workspace);
  };
  const Fitted sun = left(false), harmonics = left(true);
  const auto beyond = [](const Fitted& f) {
    const double chi = f.evaluation.chi(false);
    return chi * chi - 1.0;
  };
  EXPECT_GT(beyond(sun), 20.0) << "a sky and a sun tell all of it";
  EXPECT_LT(beyond(harmonics), 0.05 * beyond(sun));
  EXPECT_NEAR(test::value_of(harmonics, "mu"), 0.02, 0.0004);
  // What a face gets from the lamps and from the room, by the fitted numbers.
  UnevenLight L;
  for (int k = 0; k < kUnevenNumbers; ++k)
    L[k] = test::value_of(harmonics, std::string("light.") + harmonic_names[k + 1]);
  const Irradiance E(even_by_harmonic * test::value_of(harmonics, "light.L00"), L);
  for (const Vector3d& n : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 1, 0)}) {
    double truth = kRoom;
    for (const Vector3d& lamp : two_lamps()) truth += std::max(0.0, n.dot(lamp));
    EXPECT_NEAR(E.at(n), truth, 0.04 * truth);
  }
}

}  // namespace
}  // namespace hookeye
