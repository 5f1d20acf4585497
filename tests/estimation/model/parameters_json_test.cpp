// Parameters as files have them.
#include "estimation/model/parameters_json.h"

#include <gtest/gtest.h>

namespace hookeye {
namespace {

/// A linear interval may reach beyond where the parameter ends; what is told does not.
TEST(ParametersJson, IntervalsEndWhereTheParameterDoes) {
  const Parameter place{"x", "mm", "centre of the place, x", 0.0, -20.0, 55.0, 1.0, false};
  const Parameter free{"mu", "MPa", "shear modulus"};
  const Eigen::Vector2d value(48.0, 0.05), low(-90.0, 0.04), high(98.0, 0.06);
  EXPECT_FALSE(parameters_json({place, free}, value, nullptr, nullptr)[0].contains("low"));
  const Eigen::VectorXd lows = low, highs = high;
  const auto told = parameters_json({place, free}, value, &lows, &highs);
  EXPECT_EQ(told[0]["low"], -20.0);
  EXPECT_EQ(told[0]["high"], 55.0);
  EXPECT_EQ(told[1]["low"], 0.04);
  EXPECT_EQ(told[1]["high"], 0.06);
}

}  // namespace
}  // namespace hookeye
