#include "estimation/evaluation.h"

#include <gtest/gtest.h>

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
    const auto result = workspace.evaluate(form, Eigen::VectorXd::Constant(1, mu), options);
    const auto* evaluation = std::get_if<Evaluation>(&result);
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

}  // namespace
}  // namespace hookeye
