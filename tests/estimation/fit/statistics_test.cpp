// The short form of bench/statistics: what holds over 200 captures may not fail on a few.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/repeats.h"

namespace hookeye {
namespace {

TEST(Statistics, HoldWhereNothingIsHidden) {
  constexpr int kCaptures = 6;
  std::vector<double> p;
  int named = 0, missed = 0;
  double spread = 0.0;
  for (unsigned seed = 1; seed <= kCaptures; ++seed) {
    const test::Placebo placebo(seed);
    DiagnosisOptions options;
    options.also = {&placebo};
    const test::Repeat one =
        test::repeat({.told = "0.0215", .same_renderer = true, .seed = seed}, options);
    p.push_back(one.p_value);
    named += !one.named.empty();
    missed += !one.covered;
    spread += one.over_deviation * one.over_deviation;
  }
  // chi^2 of six: 0.1 % and 99.9 % points. Intervals of what nothing is known of cover always.
  EXPECT_GT(spread, 0.381);
  EXPECT_LT(spread, 22.46);
  EXPECT_LE(named, test::count_95(kCaptures));
  EXPECT_LE(missed, test::count_95(kCaptures));
  EXPECT_LE(test::distance_from_uniform(p), test::distance_95(kCaptures));
}

/// Photos by other rays than the fit's: errors that move together in a photo.
TEST(Statistics, IntervalsHoldWhereNoiseIsNotAll) {
  constexpr int kCaptures = 6;
  int missed = 0;
  double spread = 0.0;
  for (unsigned seed = 1; seed <= kCaptures; ++seed) {
    const test::Repeat one = test::repeat_fit({.told = "0.0215", .seed = seed});
    missed += !one.covered;
    spread += one.over_deviation * one.over_deviation;
  }
  EXPECT_LE(missed, test::count_95(kCaptures));
  // Too wide rather than too narrow, for few photos know their scatter badly; at most three times.
  EXPECT_GT(9.0 * spread, 0.381);
}

TEST(Statistics, APlaceboDoesNotComeFirst) {
  for (unsigned seed : {1u, 2u}) {
    const test::Placebo placebo(seed);
    DiagnosisOptions options;
    options.also = {&placebo};
    const test::Repeat one = test::repeat({.hidden = "hidden:\n  - {effect: gravity, rms_px: 1}\n",
                                           .same_renderer = true,
                                           .seed = seed},
                                          options);
    // what gravity is taken for may come before it until both are refitted (Discover tests)
    EXPECT_NE(one.first, "placebo");
    EXPECT_FALSE(one.named.empty());
  }
}

/// A test that cannot fail proves nothing: p-values that are too small or too large are noticed.
TEST(Statistics, ExcessAndCountsKnowTheUniformDistribution) {
  std::vector<double> uniform, small, large;
  for (int i = 0; i < 200; ++i) {
    uniform.push_back((i + 0.5) / 200.0);
    small.push_back(std::pow((i + 0.5) / 200.0, 1.5));
    large.push_back(std::pow((i + 0.5) / 200.0, 0.7));
  }
  EXPECT_LT(test::excess_over_uniform(uniform), test::excess_95(200));
  EXPECT_GT(test::excess_over_uniform(small), test::excess_95(200));
  EXPECT_LT(test::distance_from_uniform(uniform), test::distance_95(200));
  EXPECT_GT(test::distance_from_uniform(small), test::distance_95(200));
  EXPECT_LT(test::excess_over_uniform(large), test::excess_95(200));
  EXPECT_GT(test::distance_from_uniform(large), test::distance_95(200));
  EXPECT_NEAR(test::distance_95(20), 0.2941, 0.002);  // tabulated two-sided 5 % point
  EXPECT_NEAR(test::excess_95(20), 0.2647, 0.002);    // tabulated one-sided 5 % point
  EXPECT_EQ(test::count_95(20), 3);
  EXPECT_EQ(test::count_95(200), 15);
}

}  // namespace
}  // namespace hookeye
