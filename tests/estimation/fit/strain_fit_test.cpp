// Fits, floors and searches from fields of strains alone.
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

TEST(StrainFit, IntervalsHoldTheTruth) {
  double sum = 0.0;
  constexpr int kDraws = 8;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const Fitted fitted = fitted_to(FieldBlock{.mu = 0.05,
                                               .sigma = 0.01,
                                               .keys = ", correlation: 0, gauge: 4",
                                               .seed = seed,
                                               .strain = seed % 2 ? "green" : "hencky"}
                                        .scene());
    EXPECT_TRUE(fitted.converged);
    const double half = 0.5 * std::log(fitted.high[0] / fitted.low[0]) / 1.96;
    sum += std::pow(std::log(fitted.p[0] / 0.05) / half, 2);
    EXPECT_LT(half, 0.05);
    EXPECT_NEAR(fitted.evaluation.chi(false), 1.0, 0.1);
  }
  EXPECT_LT(sum, 15.5) << "95 % point of chi^2 of eight";
  EXPECT_GT(sum, 0.7) << "1/2000 point";
}

TEST(StrainFit, TheFloorIsThatOfTheFieldAtRest) {
  const auto scene =
      FieldBlock{.sigma = 0.002, .told = 0.001, .keys = ", correlation: 0", .strain = "green"}
          .scene();
  const Floor floor = measure_floor(*scene, fitted_to(scene).evaluation);
  EXPECT_EQ(floor.source, "rest fields");
  EXPECT_NEAR(floor.chi, 2.0, 0.2);
}

TEST(StrainFit, DiscoverNamesAWeightFromStrainsAlone) {
  const auto scene =
      FieldBlock{.gravity = {4000, 0, -9000}, .sigma = 5e-4, .strain = "green"}.scene();
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = discover(workspace, form, form.initial(), {});
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  const Discovery& found = *result;
  ASSERT_EQ(found.steps.size(), 2u) << found.sentence;
  EXPECT_EQ(found.steps[1].added, "gravity") << found.sentence;
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  const Fitted& fitted = found.steps[1].fitted;
  const VectorXd truth = (VectorXd(4) << 0.05, 4000, 0, -9000).finished();
  for (int i = 0; i < 4; ++i) {
    EXPECT_LT(fitted.low[i], truth[i]) << i;
    EXPECT_GT(fitted.high[i], truth[i]) << i;
  }
}

}  // namespace
}  // namespace hookeye::test
