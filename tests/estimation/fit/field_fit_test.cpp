// Fits, floors and searches from measured fields alone: no camera, no photo.
#include <gmock/gmock.h>

#include <cmath>

#include "estimation/field_block.h"
#include "estimation/fit/field_floor.h"
#include "estimation/fit/fit.h"
#include "estimation/search/discover.h"

namespace hookeye::test {
namespace {

Fitted fitted_to(std::shared_ptr<const Scene> scene) {
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  auto result = fit(workspace, form, form.initial());
  if (!result) throw std::runtime_error(result.error().reason);
  return *std::move(result);
}

/// Twelve draws of the noise: the intervals hold the truth, and are no wider than they must be.
TEST(FieldFit, IntervalsHoldTheTruth) {
  for (const bool alike : {false, true}) {
    double sum = 0.0, held_out = 0.0;
    constexpr int kDraws = 12;
    for (unsigned seed = 1; seed <= kDraws; ++seed) {
      const Fitted fitted = fitted_to(FieldBlock{.mu = 0.05,
                                                 .sigma = 0.3,
                                                 .alike = alike,
                                                 .keys = alike ? "" : ", correlation: 0",
                                                 .seed = seed}
                                          .scene());
      ASSERT_EQ(fitted.p.size(), 1);
      EXPECT_TRUE(fitted.converged);
      const double half = 0.5 * std::log(fitted.high[0] / fitted.low[0]) / 1.96;
      sum += std::pow(std::log(fitted.p[0] / 0.05) / half, 2);
      EXPECT_NEAR(fitted.evaluation.chi(false), 1.0, alike ? 0.3 : 0.1);
      held_out += fitted.evaluation.chi(true) / kDraws;
    }
    EXPECT_GT(held_out, 0.9);
    EXPECT_LT(held_out, 1.4) << "noise, and what the fitted values do not know";
    EXPECT_LT(sum, 21.0) << "95 % point of chi^2 of twelve";
    EXPECT_GT(sum, 2.0) << "1/2000 point";
  }
}

/// Nine points that err alike are one number: told as many, they would promise three times too
/// much.
TEST(FieldFit, DensePointsPromiseNoMoreThanTheyKnow) {
  const auto width = [](const std::string& keys) {
    const Fitted fitted = fitted_to(FieldBlock{.sigma = 0.1, .alike = true, .keys = keys}.scene());
    return std::log(fitted.high[0] / fitted.low[0]);
  };
  EXPECT_GT(width(""), 0.8 * width(", correlation: 0"))
      << "what hangs together farther than is told is seen in the residual";
}

TEST(FieldFit, TheFloorIsThatOfTheFieldAtRest) {
  const auto floor_of = [](const FieldBlock& block) {
    const auto scene = block.scene();
    return measure_floor(*scene, fitted_to(scene).evaluation);
  };
  const Floor rest = floor_of({.sigma = 0.02, .told = 0.01, .keys = ", correlation: 0"});
  EXPECT_EQ(rest.source, "rest fields");
  EXPECT_NEAR(rest.chi, 2.0, 0.2);
  const Floor weight =
      floor_of({.gravity = {0, 0, -9810}, .sigma = 0.01, .keys = ", correlation: 0"});
  EXPECT_NEAR(weight.chi, 1.0, 0.1) << "what moves smoothly is no noise";
  const Floor loaded = floor_of({.gravity = {0, 0, -9810},
                                 .sigma = 0.02,
                                 .told = 0.01,
                                 .keys = ", correlation: 0",
                                 .rest = false});
  EXPECT_EQ(loaded.source, "loaded fields");
  EXPECT_NEAR(loaded.chi, 2.0, 0.2);
  const Floor told = floor_of({.sigma = 0.005, .told = 0.01, .rest = false});
  EXPECT_EQ(told.source, "told noise");
  EXPECT_DOUBLE_EQ(told.chi, 1.0);
}

TEST(FieldFit, DiscoverNamesAWeightFromFieldsAlone) {
  const auto scene = FieldBlock{.gravity = {4000, 0, -9000}, .sigma = 0.005}.scene();
  ASSERT_TRUE(scene->capture.cameras.empty());
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = discover(workspace, form, form.initial(), {});
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  const Discovery& found = *result;
  ASSERT_EQ(found.steps.size(), 2u) << found.sentence;
  EXPECT_GT(found.steps[0].fitted.evaluation.chi(false), 3.0);
  EXPECT_EQ(found.steps[1].added, "gravity") << found.sentence;
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_THAT(found.sentence, testing::HasSubstr("held-out fields"));
  const Fitted& fitted = found.steps[1].fitted;
  const VectorXd truth = (VectorXd(4) << 0.05, 4000, 0, -9000).finished();
  for (int i = 0; i < 4; ++i) {
    EXPECT_LT(fitted.low[i], truth[i]) << i;
    EXPECT_GT(fitted.high[i], truth[i]) << i;
  }
}

/// Nothing is hidden: nothing is named.
TEST(FieldFit, DiscoverNamesNothingWhereNothingIsMissing) {
  const auto scene = FieldBlock{.sigma = 0.005, .seed = 7}.scene();
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = discover(workspace, form, form.initial(), {});
  ASSERT_TRUE(result.has_value());
  const Discovery& found = *result;
  EXPECT_EQ(found.steps.size(), 1u) << found.sentence;
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
}

}  // namespace
}  // namespace hookeye::test
