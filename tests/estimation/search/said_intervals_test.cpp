// A sentence with the ranges of its numbers: of those that it derives from the values, too.
#include "estimation/search/said_intervals.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "estimation/effects/toolbox.h"
#include "estimation/model/parameters_json.h"

namespace hookeye::test {
namespace {

KnownValues known(const VectorXd& value, const VectorXd& half) {
  return {value, value - half, value + half, Eigen::MatrixXd::Identity(value.size(), value.size())};
}

TEST(SaidIntervals, WhatTheSentenceDerivesHasItsRange) {
  const auto said = [](double half) {
    return said_with_intervals(
        [](const VectorXd& g) {
          return fmt::format("self-weight of 'pull_2', {} m/s2 towards {}", figure(g.norm()),
                             vector_text(Vector3d(g.normalized())));
        },
        known(Vector3d(3, 0, -4), Vector3d::Constant(half)));
  };
  EXPECT_EQ(said(0.0), "self-weight of 'pull_2', 5 m/s2 towards (0.60, 0.00, -0.80)");
  EXPECT_EQ(said(1e-5), said(0.0)) << "every digit is known";
  // The norm moves by its own direction's share of each value: as far as one value does.
  EXPECT_EQ(said(0.1),
            "self-weight of 'pull_2', 5 (4.9 to 5.1) m/s2 towards (0.60, 0.00, -0.80) within 1.4 "
            "degrees; ranges: 95 %");
}

/// No component is told beyond one.
TEST(SaidIntervals, ADirectionHasACone) {
  const auto axis = [](const VectorXd& v) {
    return fmt::format("fibres along {}",
                       vector_text(Vector3d(std::cos(v[0]), std::sin(v[0]), 0.0)));
  };
  const VectorXd zero = VectorXd::Zero(1);
  EXPECT_EQ(said_with_intervals(axis, known(zero, VectorXd::Constant(1, 0.1))),
            "fibres along (1.00, 0.00, 0.00) within 7.2 degrees; ranges: 95 %");
  EXPECT_EQ(said_with_intervals(axis, known(zero, VectorXd::Constant(1, 1.5))),
            "fibres along (1.00, 0.00, 0.00) within 72 degrees; ranges: 95 %");
}

/// A stiffness that is unstable at an end of its interval has no modulus there.
TEST(SaidIntervals, WhatHasNoValueAtAnEndIsNotKnown) {
  const auto modulus = [](const VectorXd& v) {
    return fmt::format("Young's modulus {} MPa, mean {} of nanometres",
                       figure(v[0] > 0.0 ? v[0] : std::nan("")), figure(v[1]));
  };
  EXPECT_EQ(said_with_intervals(modulus, known(Eigen::Vector2d(0.2, 3), Eigen::Vector2d(0.3, 1))),
            "Young's modulus 0.2 (not known) MPa, mean 3 (2 to 4) of nanometres; ranges: 95 %");
  EXPECT_EQ(said_with_intervals(modulus, known(Eigen::Vector2d(-1, 3), Eigen::Vector2d(0.3, 1))),
            "Young's modulus not known MPa, mean 3 (2 to 4) of nanometres; ranges: 95 %");
  EXPECT_EQ(said_with_intervals(modulus, known(Eigen::Vector2d(0.2, 3), Eigen::Vector2d(0.1, 0))),
            "Young's modulus 0.2 (0.1 to 0.3) MPa, mean 3 of nanometres; ranges: 95 %");
}

/// A vector that may be none, or the opposite, points anywhere.
TEST(SaidIntervals, AVectorThroughZeroMayPointAnywhere) {
  const auto pull = [](const VectorXd& v) {
    return fmt::format("a pull towards {}", vector_text(Vector3d(v[0], 0.0, 0.0).normalized()));
  };
  const VectorXd value = VectorXd::Constant(1, 0.1);
  EXPECT_EQ(said_with_intervals(pull, known(value, 3.0 * value)),
            "a pull towards (1.00, 0.00, 0.00) within 180 degrees; ranges: 95 %");
  EXPECT_EQ(said_with_intervals(pull, known(value, 0.5 * value)),
            "a pull towards (1.00, 0.00, 0.00)");
}

/// Two values that go against each other leave their sum as it is.
TEST(SaidIntervals, CorrelatedValuesGoTogether) {
  KnownValues values = known(Eigen::Vector2d(2, 3), Eigen::Vector2d(0.5, 0.5));
  const auto sum = [](const VectorXd& v) { return fmt::format("a sum of {}", figure(v.sum())); };
  EXPECT_EQ(said_with_intervals(sum, values), "a sum of 5 (4.29 to 5.71); ranges: 95 %");
  values.correlation << 1, -1, -1, 1;
  EXPECT_EQ(said_with_intervals(sum, values), "a sum of 5");
  values.correlation << 1, 1, 1, 1;
  EXPECT_EQ(said_with_intervals(sum, values), "a sum of 5 (4 to 6); ranges: 95 %");
}

/// Sums of squares do not carry a factor below nothing.
TEST(SaidIntervals, AFactorStaysPositive) {
  const auto factor = [](const VectorXd& v) {
    return fmt::format("{} times", figure(std::exp(v.sum())));
  };
  const VectorXd value = Eigen::Vector2d::Zero(), half = Eigen::Vector2d::Constant(std::log(10.0));
  EXPECT_EQ(said_with_intervals(factor, known(value, half)),
            "1 (0.0385 to 26) times; ranges: 95 %");
}

TEST(SaidIntervals, WhereTheWordsChangeBothAreSaid) {
  const auto pressure = [](const VectorXd& v) {
    return fmt::format("a {} of {} MPa", v[0] >= 0 ? "pressure" : "suction",
                       figure(std::abs(v[0])));
  };
  const VectorXd value = VectorXd::Constant(1, 0.1);
  EXPECT_EQ(said_with_intervals(pressure, known(value, 0.5 * value)),
            "a pressure of 0.1 (0.05 to 0.15) MPa; ranges: 95 %");
  EXPECT_EQ(said_with_intervals(pressure, known(value, 3.0 * value)),
            "a pressure of 0.1 MPa; 95 %: from a suction of 0.2 MPa to a pressure of 0.4 MPa");
}

TEST(SaidIntervals, APlaceThatMayBeAnywhereIsToldAsThat) {
  const std::vector<Parameter> axes = {
      {"a.x", "mm", "centre of the place, x", 0, 0, 50, 5, false},
      {"a.y", "mm", "centre of the place, y", 0, 0, 20, 5, false},
      {"a.radius", "mm", "radius of the place", 0, 0, 20, 5, false}};
  EXPECT_TRUE(centre_is_unknown(axes[0], -10, 60));
  EXPECT_TRUE(centre_is_unknown(axes[0], 0, 26));
  EXPECT_FALSE(centre_is_unknown(axes[0], 0, 24));
  EXPECT_FALSE(centre_is_unknown(axes[0], -100, 24)) << "of it a half lies in the body";
  EXPECT_FALSE(centre_is_unknown(axes[2], -100, 100)) << "no place";
  KnownValues values = known(Vector3d(20, 10, 4), Vector3d(30, 1, 0));
  forget_unknown_centres(axes, values);
  const auto place = [](const VectorXd& v) {
    return fmt::format("a place around {}", place_text(Vector3d(v[0], v[1], 7.0), 42.0));
  };
  EXPECT_EQ(said_with_intervals(place, values),
            "a place around (somewhere along x, 9.0 to 11.0, 7.0); ranges: 95 %");
}

/// Nothing holds a value that has no end: what else is known is told.
TEST(SaidIntervals, AnOpenIntervalMovesNothing) {
  KnownValues values = known(Eigen::Vector2d(2, 3), Eigen::Vector2d(0.5, 0.5));
  values.low[0] = -std::numeric_limits<double>::infinity();
  values.high[0] = -values.low[0];
  EXPECT_EQ(
      said_with_intervals(
          [](const VectorXd& v) { return fmt::format("{} and {}", v[0], figure(v[1])); }, values),
      "2 and 3 (2.5 to 3.5); ranges: 95 %");
}

}  // namespace
}  // namespace hookeye::test
