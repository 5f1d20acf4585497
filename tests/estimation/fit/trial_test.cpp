// A few steps of a refit, by which effects are screened.
#include "estimation/fit/trial.h"

#include <gtest/gtest.h>

#include "estimation/field_block.h"
#include "estimation/fit/fit.h"

namespace hookeye::test {
namespace {

/// How the jaw of a held-out load case moved is a number of that case alone: what the fit made of
/// it beside the wrong modulus says nothing of the right one.
TEST(Trial, NumbersOfHeldOutCasesGoWithTheModel) {
  const FieldBlock block{.sigma = 0.01};
  const auto scene =
      ChangedBlock{block, "capture.yaml", "  push:\n    supports: [{region: base, fix: [x, y, z]}]",
                   "  push:\n    supports: [{region: base, rigid: fit}]"}
          .scene();
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto start = settle_held_out(workspace, form, form.initial());
  ASSERT_TRUE(start.has_value());
  const auto scale = trial_scale(workspace, form, *start, {});
  ASSERT_TRUE(scale.has_value());
  const auto trial = try_step(workspace, form, *start, *scale, {});
  ASSERT_TRUE(trial.has_value());
  EXPECT_NEAR(trial->p[0], 0.05, 0.003);

  VectorXd left = trial->p;
  left.tail<6>() = start->tail<6>();
  EvaluationOptions held_out;
  held_out.derivatives = false;
  held_out.held_out = true;
  const auto as_left = workspace.evaluate(form, left, held_out);
  ASSERT_TRUE(as_left.has_value());
  EXPECT_LT(trial->chi_validate, 0.5 * as_left->linear_chi(true));
  EXPECT_LT(trial->chi_validate, 2.0 * trial->chi_fit);
}

}  // namespace
}  // namespace hookeye::test
