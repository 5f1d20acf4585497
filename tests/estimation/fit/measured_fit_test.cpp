// Fits from one kind of measurement alone, without any photo.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/distributions.h"
#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/fit.h"
#include "estimation/fit/floor.h"
#include "estimation/search/discover.h"
#include "tests/estimation/small_capture.h"

namespace hookeye::test {
namespace {

using Kind = MeasuredSpec::Kind;

MeasuredSpec measured(Kind kind, double sigma) {
  MeasuredSpec out;
  out.kind = kind;
  out.region = "grip";
  out.direction = {2.0, -1.0, 40.0};
  out.point = {0.0, 0.0, 40.0};
  const int size = kind_of(out).size;
  if (size == 1) out.direction = Vector3d(0.3, 0.1, 1.0).normalized();
  out.value = VectorXd::Zero(size);
  out.sigma = VectorXd::Constant(size, sigma);
  return out;
}

/// The block under one of its loads, measured once, no photos. The value is what the model with
/// `mu` says, for the fit to find from another one.
std::shared_ptr<const Scene> measured_block(const std::string& load, const MeasuredSpec& spec,
                                            double mu) {
  auto scene = std::make_shared<Scene>(*block_scene());
  for (size_t i = 0; i < scene->capture.examples.size(); ++i) {
    ExampleSpec& example = scene->capture.examples[i];
    example.photos.clear();
    scene->photos[i].clear();
    example.measured.clear();
    if (example.name == load) example.measured = {spec};
  }
  const ModelForm form = base_form(scene);
  Workspace workspace(scene);
  VectorXd p = form.initial();
  p[0] = mu;
  const auto seen = workspace.evaluate(form, p, EvaluationOptions{}).value();
  auto known = std::make_shared<Scene>(*scene);
  const int at = scene->example_index(load);
  known->capture.examples[static_cast<size_t>(at)].measured[0].value =
      seen.find(at)->measured.at(0).predicted;
  return known;
}

void expect_found(const std::string& load, const MeasuredSpec& spec) {
  const double mu = 0.065;  // told: 0.05
  const auto scene = measured_block(load, spec, mu);
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  ASSERT_EQ(form.size(), 1);
  const auto result = fit(workspace, form, form.initial());
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  const Fitted& fitted = *result;
  EXPECT_TRUE(fitted.converged);
  EXPECT_NEAR(fitted.p[0], mu, 0.03 * (fitted.high[0] - fitted.low[0])) << "a fit ends where what "
                                                                           "is left is noise";
  EXPECT_TRUE(fitted.undetermined.empty());
  // One number by one measurement: the interval is sigma through the derivative.
  const auto& one = fitted.evaluation.find(scene->example_index(load))->measured.at(0);
  const double deviation = 1.0 / one.J.col(0).norm();
  EXPECT_NEAR(0.5 * (fitted.high[0] - fitted.low[0]), kNormal95 * deviation, 0.02 * deviation);
}

TEST(MeasuredFit, AForceAlone) { expect_found("twist", measured(Kind::force_on, 0.05)); }

TEST(MeasuredFit, AMomentAlone) { expect_found("twist", measured(Kind::moment_on, 0.5)); }

TEST(MeasuredFit, APositionAlone) { expect_found("pull", measured(Kind::position_of, 0.1)); }

TEST(MeasuredFit, ATravelAlone) { expect_found("pull", measured(Kind::travel_of, 0.1)); }

TEST(MeasuredFit, ARotationAlone) {
  MeasuredSpec turn = measured(Kind::rotation_of, 0.05);
  turn.direction = Vector3d::UnitY();  // a load across bends the block about it
  expect_found("pull", turn);
}

TEST(MeasuredFit, AStrainAlone) {
  MeasuredSpec gauge = measured(Kind::strain_of, 1e-4);
  gauge.point = {9.9, 1.0, 12.0}, gauge.direction = {9.9, 1.0, 28.0};
  expect_found("pull", gauge);
}

/// The block drawn by 2 mm, known within 0.05; a force and a position tell how far it went.
std::shared_ptr<const Scene> drawn_block(double travel, double mu, bool known_within) {
  auto scene = std::make_shared<Scene>(*block_scene());
  for (size_t i = 0; i < scene->capture.examples.size(); ++i) {
    ExampleSpec& example = scene->capture.examples[i];
    example.photos.clear(), example.measured.clear(), scene->photos[i].clear();
    if (example.name != "pull") continue;
    SupportSpec jaw;
    jaw.region = "grip";
    jaw.displacement = {0.0, 0.0, 2.0};
    example.supports.push_back(jaw);
    example.loads.clear();
    MeasuredSpec along = measured(Kind::travel_of, 0.05);
    along.direction = Vector3d::UnitZ(), along.value[0] = 2.0;
    MeasuredSpec middle = measured(Kind::position_of, 0.002);
    middle.point = {0.0, 0.0, 20.0};
    example.measured = {measured(Kind::force_on, 1e-4), middle, along};
  }
  // What is measured: the truth's, by a model that went as far as it did.
  const ModelForm form = base_form(scene);
  const int at = scene->example_index("pull");
  Workspace workspace(scene);
  const auto seen =
      workspace.evaluate(form, Eigen::Vector2d(mu, travel - 2.0), EvaluationOptions{}).value();
  auto known = std::make_shared<Scene>(*scene);
  auto& rows = known->capture.examples[static_cast<size_t>(at)].measured;
  for (size_t k = 0; k < 2; ++k) rows[k].value = seen.find(at)->measured.at(k).predicted;
  if (!known_within) rows.pop_back();
  return known;
}

/// A jaw that went 1.5 standard deviations too far: the travel takes that, not the stiffness.
TEST(MeasuredFit, ATravelKnownWithinItsSigmaIsFittedBesideTheMaterial) {
  const auto fitted_from = [](bool known_within) {
    const auto scene = drawn_block(2.075, 0.065, known_within);
    Workspace workspace(scene);
    const ModelForm form = base_form(scene);
    EXPECT_EQ(form.size(), known_within ? 2 : 1);
    return fit(workspace, form, form.initial()).value();
  };
  const Fitted free = fitted_from(true), exact = fitted_from(false);
  EXPECT_NEAR(free.p[1], 0.075, 0.005);
  EXPECT_NEAR(free.p[0], 0.065, 1e-4);
  EXPECT_EQ(free.form.parameters()[1].name, "pull.grip.travel");
  EXPECT_GT(std::abs(exact.p[0] - 0.065), 1e-3) << "taken as exact the modulus is wrong";
}

/// What is known well across and badly along the view is a covariance, not a mean of both.
TEST(MeasuredFit, ACovarianceWeighsEachDirectionByItself) {
  MeasuredSpec one = measured(Kind::position_of, 0.1), same = one, other = one;
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Vector3d sigma(0.02, 0.04, 1.0);
  same.covariance_root = Eigen::Matrix3d(0.1 * Eigen::Matrix3d::Identity());
  other.covariance_root = Eigen::Matrix3d(
      Eigen::LLT<Eigen::Matrix3d>(turned * sigma.cwiseAbs2().asDiagonal() * turned.transpose())
          .matrixL());
  const Vector3d off(0.3, -0.2, 0.4);
  EXPECT_NEAR((same.whitened(off) - one.whitened(off)).norm(), 0.0, 1e-14);
  const Vector3d seen = (turned.transpose() * off).cwiseQuotient(sigma);
  EXPECT_NEAR(other.whitened(off).norm(), seen.norm(), 1e-12);
  expect_found("pull", other);
}

/// The block without photos; positions of its surface are measured in all examples, made with a
/// weight that no one tells and noise.
std::shared_ptr<const Scene> tracked_block(double sigma) {
  auto scene = std::make_shared<Scene>(*block_scene());
  for (size_t i = 0; i < scene->capture.examples.size(); ++i) {
    ExampleSpec& example = scene->capture.examples[i];
    example.photos.clear();
    scene->photos[i].clear();
    example.measured.clear();
    for (const double z : {10.0, 20.0, 30.0, 40.0})
      for (const double x : {-10.0, 10.0}) {
        MeasuredSpec one = measured(Kind::position_of, sigma);
        one.point = {x, x < 0.0 ? -8.0 : 8.0, z};
        example.measured.push_back(one);
      }
  }
  ModelForm form = base_form(scene);
  form.ingredients.push_back(find_effect("gravity")->candidate(form.realise(form.initial()), ""));
  VectorXd p = form.initial();
  p.tail<3>() = Eigen::Vector3d(9000.0, 0.0, -20000.0);
  Workspace workspace(scene);
  EvaluationOptions all;
  all.held_out = true;
  const auto seen = workspace.evaluate(form, p, all).value();
  auto known = std::make_shared<Scene>(*scene);
  std::mt19937 engine(3);
  std::normal_distribution<double> normal(0.0, sigma);
  for (const auto& example : seen.examples)
    for (const auto& one : example.measured) {
      VectorXd& value =
          known->capture.examples[static_cast<size_t>(example.example)].measured[one.index].value;
      value = one.predicted;
      for (double& x : value) x += normal(engine);
    }
  return known;
}

/// A search works on positions alone too: the misfit is theirs, over their told noise.
TEST(MeasuredFit, DiscoverNamesAnEffectFromPositionsAlone) {
  const auto scene = tracked_block(0.004);
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = discover(workspace, form, form.initial(), {});
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  const Discovery& found = *result;
  ASSERT_EQ(found.steps.size(), 2u) << found.sentence;
  EXPECT_GT(found.steps[0].fitted.evaluation.chi(false), 3.0);
  EXPECT_EQ(found.steps[1].added, "gravity") << found.sentence;
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_NEAR(found.steps[1].fitted.evaluation.chi(false), 1.0, 0.2);
}

/// Photos that err as their noise says leave measured values their weight. What is wrong in the
/// same way over many pixels makes few of a million, and a force more beside them.
TEST(MeasuredFit, WhatPhotosErrByTogetherGivesForcesMoreWeight) {
  const SmallScene small({.same_renderer = true});
  auto wrong = std::make_shared<Scene>(*small.scene);
  for (auto& example : wrong->photos)
    for (Photo& photo : example)
      for (auto& shared : photo.planes) {
        Image& plane = shared.own();
        for (int y = 0; y < plane.height; ++y)
          for (int x = 0; x < plane.width; ++x)
            plane.at(x, y) *=
                static_cast<float>(1.0 + 0.03 * std::sin(0.2 * x) * std::sin(0.15 * y));
      }
  const auto weight_in = [](std::shared_ptr<const Scene> scene) {
    Workspace workspace(scene);
    const Fitted fitted = base_fit(workspace);
    EXPECT_DOUBLE_EQ(fitted.evaluation.measured_weight, measured_weight(*scene, fitted.evaluation));
    return fitted.evaluation.measured_weight;
  };
  // The fit ends where photos and forces pull alike with that weight, and not with another.
  for (auto& example : wrong->capture.examples)
    for (auto& spec : example.measured) spec.sigma /= 30.0;
  Workspace workspace(wrong);
  Evaluation end = base_fit(workspace).evaluation;
  const auto pull = [&](double weight) {
    end.measured_weight = weight;
    const NormalEquations sums = normal_equations(end);
    return std::abs(sums.Jtr[0]) / sums.JtJ(0, 0);
  };
  const double own = pull(end.measured_weight);
  EXPECT_LT(own, 0.2 * pull(1.0));
  EXPECT_LT(weight_in(small.scene), 2.0);
  EXPECT_GT(weight_in(wrong), 5.0);
}

/// A load that nobody has measured is a candidate of a plan: that it has no equilibrium stops no
/// fit.
TEST(MeasuredFit, ALoadWithoutDataIsNotSolved) {
  auto scene = std::make_shared<Scene>(*tracked_block(0.004));
  ExampleSpec crush = scene->capture.examples[1];
  crush.name = "crush";
  crush.measured.clear();
  for (LoadSpec& load : crush.loads) *load.force *= -1e4;
  scene->capture.examples.push_back(crush);
  scene->photos.emplace_back();
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, form.initial());
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  EXPECT_EQ(result->evaluation.examples.size(), scene->capture.examples.size() - 1);
}

}  // namespace
}  // namespace hookeye::test
