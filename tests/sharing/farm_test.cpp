// Many workers, some of whom die or are out of sight: every task ends, once, and little time goes
// into arranging that.
#include <gtest/gtest.h>

#include "sharing/simulated_farm.h"

namespace hookeye::test {
namespace {

TEST(Farm, LosesNothingAndDoesNothingTwice) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Farm farm{.tasks = 400, .workers = 20, .deaths = 8, .out_of_sight = 2, .seed = seed};
    const FarmResult result = simulate(farm);
    SCOPED_TRACE(result.words());
    EXPECT_EQ(result.done + result.failed, farm.tasks);
    EXPECT_GT(result.failed, 0);
    EXPECT_EQ(result.lost, 0);
    EXPECT_EQ(result.twice, 0);
    EXPECT_EQ(result.left_over, 0);
    EXPECT_GT(result.wasted, 0.0) << "of those who died";
  }
}

TEST(Farm, ArrangingTakesLittle) {
  const FarmResult result =
      simulate({.tasks = 2000, .workers = 40, .deaths = 0, .out_of_sight = 0});
  SCOPED_TRACE(result.words());
  EXPECT_EQ(result.done + result.failed, 2000);
  EXPECT_EQ(result.wasted, 0.0);
  EXPECT_LT(result.overhead(), 0.01);
}

TEST(Farm, IsTheSameWithTheSameSeed) {
  const Farm farm{.tasks = 100, .workers = 5, .deaths = 1, .out_of_sight = 1};
  EXPECT_EQ(simulate(farm).words(), simulate(farm).words());
}

}  // namespace
}  // namespace hookeye::test
