// Fits from one kind of measurement alone, without any photo.
#include <gtest/gtest.h>

#include "estimation/effects_scene.h"
#include "estimation/fit.h"

namespace hookeye::test {
namespace {

using Kind = MeasuredSpec::Kind;

MeasuredSpec measured(Kind kind, double sigma) {
  MeasuredSpec out;
  out.kind = kind;
  out.region = "grip";
  out.about = {2.0, -1.0, 40.0};
  out.point = {0.0, 0.0, 40.0};
  out.value.setZero();
  out.sigma = sigma;
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
  const auto seen = std::get<Evaluation>(workspace.evaluate(form, p, EvaluationOptions{}));
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
  ASSERT_TRUE(std::holds_alternative<Fitted>(result)) << std::get<NumericalFailure>(result).reason;
  const Fitted& fitted = std::get<Fitted>(result);
  EXPECT_TRUE(fitted.converged);
  EXPECT_NEAR(fitted.p[0], mu, 0.03 * (fitted.high[0] - fitted.low[0])) << "a fit ends where what "
                                                                           "is left is noise";
  EXPECT_TRUE(fitted.undetermined.empty());
  // One number by one measurement: the interval is sigma through the derivative.
  const auto& one = fitted.evaluation.find(scene->example_index(load))->measured.at(0);
  const double deviation = 1.0 / one.J.col(0).norm();
  EXPECT_NEAR(0.5 * (fitted.high[0] - fitted.low[0]), kNormal95 * deviation, 0.02 * deviation);
}

TEST(MeasuredFit, AForceAlone) { expect_found("twist", measured(Kind::force, 0.05)); }

TEST(MeasuredFit, AMomentAlone) { expect_found("twist", measured(Kind::moment, 0.5)); }

TEST(MeasuredFit, APositionAlone) { expect_found("pull", measured(Kind::position, 0.1)); }

}  // namespace
}  // namespace hookeye::test
