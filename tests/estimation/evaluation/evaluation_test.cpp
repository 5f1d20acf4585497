#include "estimation/evaluation/evaluation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimation/effects/catalogue.h"
#include "estimation/model/effect.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::SmallScene;

/// What evaluations at these moduli leave, one after the other in one workspace; 0 where one
/// example has no equilibrium.
std::vector<double> misfits(const SmallScene& small, const std::vector<double>& moduli) {
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  EvaluationOptions options;
  options.most_iterations = kStepIterations;
  std::vector<double> out;
  for (const double mu : moduli) {
    const auto evaluation = workspace.evaluate(form, Eigen::VectorXd::Constant(1, mu), options);
    out.push_back(evaluation ? evaluation->chi(false) : 0.0);
  }
  return out;
}

/// Which of the others were solved before one failed is chance on two cores: the next evaluation
/// starts where the last whole one ended, bit for bit.
TEST(Evaluation, AFailedOneLeavesNothingBehind) {
  const SmallScene small({});
  const auto way = misfits(small, {0.02, 1e-6, 0.021});
  ASSERT_GT(way[0], 0.0);
  ASSERT_EQ(way[1], 0.0) << "a body as soft as this has no equilibrium under the pull";
  const auto direct = misfits(small, {0.02, 0.021});
  EXPECT_NEAR(way[2], direct[1], 1e-6 * direct[1]);
  for (int again = 0; again < 3; ++again) EXPECT_EQ(misfits(small, {0.02, 1e-6, 0.021}), way);
}

/// No number is no equilibrium, wherever the last one ended.
TEST(Evaluation, OfNoNumberFails) {
  const SmallScene small({});
  const auto way = misfits(small, {0.02, std::numeric_limits<double>::quiet_NaN(), 0.021});
  EXPECT_EQ(way[1], 0.0);
  EXPECT_NEAR(way[2], misfits(small, {0.02, 0.021})[1], 1e-6 * way[2]);
}

/// Levels of photos are made when they are asked for, and go once whole photos are.
TEST(Evaluation, CoarsePhotosAreThereAgainAfterWholeOnes) {
  const SmallScene small({});
  const ModelForm form = base_form(small.scene);
  Workspace workspace(small.scene);
  const auto at_level = [&](int level) {
    EvaluationOptions options;
    options.level = level;
    return workspace.evaluate(form, form.initial(), options).value().chi(false);
  };
  const double coarse = at_level(2), whole = at_level(0), again = at_level(2);
  EXPECT_GT(std::abs(coarse - whole), 1e-3 * whole);
  EXPECT_NEAR(again, coarse, 1e-6 * coarse);
  EXPECT_NEAR(at_level(0), whole, 1e-6 * whole);
}

int newton_iterations(const Evaluation& evaluation) {
  int all = 0;
  for (const auto& example : evaluation.examples) all += example.equilibrium->newton_iterations;
  return all;
}

/// After a step along known derivatives equilibria are where these take them, but for the square
/// of the step.
TEST(Evaluation, DerivativesTellWhereTheNextOneStarts) {
  const SmallScene small({});
  ModelForm form = base_form(small.scene);
  form.ingredients.push_back(
      find_effect("gravity")->candidates(form.realise(form.initial()), nullptr).front());
  const auto step = [&](bool derivatives) {
    Workspace workspace(small.scene);
    EvaluationOptions options;
    options.derivatives = derivatives;
    const auto at = [&](double weight) {
      Eigen::VectorXd p = form.initial();
      p.tail(3) << 0.3 * weight, 0.0, weight;
      return workspace.evaluate(form, p, options).value();
    };
    at(-9000.0);
    return at(-12000.0);
  };
  const Evaluation told = step(true), untold = step(false);
  EXPECT_LT(newton_iterations(told), newton_iterations(untold));
  for (size_t e = 0; e < told.examples.size(); ++e)
    EXPECT_LT(
        (told.examples[e].equilibrium->q - untold.examples[e].equilibrium->q).cwiseAbs().maxCoeff(),
        1e-6);
}

}  // namespace
}  // namespace hookeye
