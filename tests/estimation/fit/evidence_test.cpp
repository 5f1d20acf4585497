// Evidence against simulation: chance does not reach it, a real signal does, size does not buy it.
#include "estimation/fit/evidence.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Data {
  MatrixXd J;
  VectorXd r;
};

Data noise(std::mt19937& engine, int rows, int columns) {
  std::normal_distribution<double> normal;
  Data data{MatrixXd(rows, columns), VectorXd(rows)};
  for (double& x : data.J.reshaped()) x = normal(engine);
  for (double& x : data.r) x = normal(engine);
  return data;
}

double evidence(const Data& data, int base, int count, bool one_sided = false) {
  const MatrixXd H = data.J.transpose() * data.J;
  const VectorXd s = data.J.transpose() * data.r;
  const auto projected = project(H, base, {base, count, VectorXd::Ones(count), one_sided});
  const VectorXd a = H.topLeftCorner(base, base).ldlt().solve(s.head(base));
  return log_evidence(projected, s, data.r.squaredNorm() - s.head(base).dot(a),
                      static_cast<double>(data.r.size()), 1.0);
}

TEST(Evidence, ChanceSeldomReachesThree) {
  std::mt19937 engine(5);
  int one = 0, field = 0;
  for (int i = 0; i < 300; ++i) {
    one += evidence(noise(engine, 200, 3), 2, 1) > 3.0;
    field += evidence(noise(engine, 200, 18), 2, 16) > 3.0;
  }
  EXPECT_LT(one, 15);
  EXPECT_LT(field, 15);
}

TEST(Evidence, FindsASignalAndPrefersTheSmallerForm) {
  std::mt19937 engine(6);
  for (int i = 0; i < 20; ++i) {
    Data data = noise(engine, 200, 18);
    data.r -= 0.6 * data.J.col(2);  // eight standard deviations
    const double exact = evidence(data, 2, 1), field = evidence(data, 2, 16);
    EXPECT_GT(exact, 5.0);
    EXPECT_GT(exact, field);
  }
}

/// Sensors: few values of told noise. What is left by the effect itself is noise to it, so that one
/// that removes half of a misfit does not feed on the other half; and a single value far off
/// speaks.
TEST(Evidence, ToldNoiseLetsFewValuesSpeak) {
  const auto of = [](const MatrixXd& J, const VectorXd& r, double noise2) {
    const auto n = static_cast<int>(J.cols());
    const MatrixXd H = J.transpose() * J;
    return log_evidence_of_told_noise(project(H, 0, {0, n, VectorXd::Ones(n)}), J.transpose() * r,
                                      r.squaredNorm(), static_cast<double>(r.size()), noise2);
  };
  const MatrixXd offset = MatrixXd::Identity(3, 3);
  const Eigen::Vector3d far(100.0, 0.0, 0.0);
  EXPECT_GT(of(offset, far, 1.0), 1000.0);
  EXPECT_LT(of(offset, far, 1e4), 1.0) << "the mesh alone would change it by as much";
  EXPECT_LT(of(offset, Eigen::Vector3d(1.0, -0.5, 0.8), 1.0), 1.0);
  // Ten values; one parameter that takes away the mean of them.
  const VectorXd ones = VectorXd::Ones(10);
  EXPECT_GT(of(ones, 10.0 * ones, 1.0), 300.0);
  VectorXd scattered = 10.0 * ones;
  for (int i = 0; i < 10; ++i) scattered[i] += i % 2 ? 30.0 : -30.0;
  EXPECT_LT(of(ones, scattered, 1.0), 3.0);
}

/// A clamp cannot be stiffer than rigid along its normal: the parameter that would have to shrink
/// below its null is held, and the evidence is the other's alone.
TEST(Evidence, WhatMayOnlyGrowDoesNotShrink) {
  std::mt19937 engine(8);
  Data data = noise(engine, 200, 3);
  data.r -= 0.6 * data.J.col(1) - 0.5 * data.J.col(2);
  const MatrixXd H = data.J.transpose() * data.J;
  const VectorXd s = data.J.transpose() * data.r;
  Hypothesis both{1, 2, VectorXd::Ones(2)}, first{1, 1, VectorXd::Ones(1)};
  both.grows = {true, true};
  const Hypothesis kept = within_bounds(H, 1, both, s);
  EXPECT_EQ(kept.held, std::vector<bool>({false, true}));
  const auto p = project(H, 1, kept);
  EXPECT_EQ(p.step(s)[1], 0.0);
  EXPECT_NEAR(p.step(s)[0], project(H, 1, first).step(s)[0], 1e-12);
  EXPECT_NEAR(p.fall(s), project(H, 1, first).fall(s), 1e-9);
  const double r2 = data.r.squaredNorm();
  EXPECT_NEAR(log_evidence(p, s, r2, 200.0, 1.0),
              log_evidence(project(H, 1, first), s, r2, 200.0, 1.0), 1e-9);
  EXPECT_LT(bayes_information(p, s, r2, 200.0, 1.0),
            bayes_information(project(H, 1, both), s, r2, 200.0, 1.0));
  // Where both would grow none is held.
  both.grows = {true, false};
  EXPECT_TRUE(within_bounds(H, 1, both, s).held.empty());
}

/// A factor on a stiffness cannot fall below -1: a best fit beyond its bound counts for what it
/// gains at the bound, whichever side that is on.
TEST(Evidence, ABoundCutsTheGainOnBothSides) {
  std::mt19937 engine(9);
  Data data = noise(engine, 200, 2);
  data.r -= 0.8 * data.J.col(1);
  const MatrixXd H = data.J.transpose() * data.J;
  const double r2 = data.r.squaredNorm();
  for (const double sign : {1.0, -1.0}) {
    const VectorXd s = sign * data.J.transpose() * data.r;
    Hypothesis free{1, 1, VectorXd::Ones(1)}, bounded = free, other = free;
    bounded.least = -0.1, bounded.most = 0.1;
    (sign > 0 ? other.least : other.most) = sign * -0.1;  // the side where the fit is not
    const auto p = project(H, 1, bounded);
    EXPECT_DOUBLE_EQ(p.step(s)[0], sign * 0.1);
    const double gained = log_evidence(p, s, r2, 200.0, 1.0);
    const double best = log_evidence(project(H, 1, free), s, r2, 200.0, 1.0);
    EXPECT_GT(gained, 5.0);
    EXPECT_LT(gained, 0.6 * best);
    EXPECT_DOUBLE_EQ(log_evidence(project(H, 1, other), s, r2, 200.0, 1.0), best);
  }
}

/// Two higher moduli of a law nearly undo each other: held at its bound alone, one would leave the
/// other's large step behind, which is worse than none.
TEST(Evidence, AStepWithinBoundsIsTheBestThere) {
  std::mt19937 engine(9);
  Data data = noise(engine, 200, 3);
  data.J.col(2) = data.J.col(1) + 0.05 * data.J.col(2);
  data.r -= 4.0 * data.J.col(1) - 6.0 * data.J.col(2);
  const MatrixXd H = data.J.transpose() * data.J;
  const VectorXd s = data.J.transpose() * data.r;
  const auto p = project(H, 1, {1, 2, VectorXd::Ones(2)});
  const auto change = [&](const VectorXd& t) {
    return 2.0 * t.dot(p.projected_score(s)) + t.dot(p.M * t);
  };
  const double inf = std::numeric_limits<double>::infinity();
  const Eigen::Vector2d low(-inf, -1.0), high(inf, 1.0);
  ASSERT_LT(p.step(s)[1], -3.0);
  const VectorXd t = p.step_within(s, low, high);
  EXPECT_EQ(t[1], -1.0);
  EXPECT_LT(change(t), 0.0);
  EXPECT_GT(change(Eigen::Vector2d(p.step(s)[0], -1.0)), 0.0);
  for (const double off : {-0.01, 0.01}) {
    EXPECT_GT(change(t + Eigen::Vector2d(off, 0.0)), change(t));
    EXPECT_GT(change(Eigen::Vector2d(t[0] + off, -0.99)), change(t));
  }
  EXPECT_EQ(p.step_within(s, Eigen::Vector2d(-inf, -inf), high), p.step(s));
}

/// A field of many bumps of which some stop at their bounds: what is held had come out as any
/// number, its step as none, and the field was not asked or was, as the last bits of the sums would
/// have it.
TEST(Evidence, AStepOfManyParametersStaysWithinBounds) {
  std::mt19937 engine(11);
  Data data = noise(engine, 200, 17);
  for (int k = 1; k < 17; ++k) data.r -= (k % 5 == 0 ? 3.0 : 0.2) * data.J.col(k);
  const MatrixXd H = data.J.transpose() * data.J;
  const VectorXd s = data.J.transpose() * data.r;
  const auto p = project(H, 1, {1, 16, VectorXd::Ones(16)});
  const VectorXd bound = VectorXd::Ones(16), t = p.step_within(s, -bound, bound);
  EXPECT_EQ((t.array() == 1.0).count(), 3);
  EXPECT_LT((t - t.cwiseMax(-bound).cwiseMin(bound)).norm(), 1e-9);
  const VectorXd slope = p.projected_score(s) + p.M * t;
  for (int k = 0; k < 16; ++k)
    if (t[k] == 1.0)
      EXPECT_LT(slope[k], 0.0) << k;
    else
      EXPECT_NEAR(slope[k], 0.0, 1e-9 * s.norm()) << k;
}

/// A blur that is in four photos and told of three: both take away more than the cells' sums hold,
/// the four more than the three.
TEST(Evidence, WhatTakesMoreThanCellsShowStillRanks) {
  const Eigen::MatrixXd H = VectorXd({{40000.0, 30000.0}}).asDiagonal();
  const VectorXd s = -0.4 * H.diagonal();
  const double r2 = 3000.0, count = 200.0;
  const auto four = project(H, 0, {0, 1, VectorXd::Ones(1)});
  const auto three = project(H, 0, {1, 1, VectorXd::Ones(1)});
  ASSERT_GT(three.fall(s), r2);
  EXPECT_GT(log_evidence(four, s, r2, count, 1.0), log_evidence(three, s, r2, count, 1.0) + 20.0);
  EXPECT_GT(bayes_information(four, s, r2, count, 1.0),
            bayes_information(three, s, r2, count, 1.0) + 20.0);
}

TEST(Evidence, WhatTheBaseCanImitateIsNoEvidence) {
  std::mt19937 engine(7);
  Data data = noise(engine, 200, 3);
  data.r -= 5.0 * data.J.col(0);
  data.J.col(2) = data.J.col(0) - data.J.col(1);
  EXPECT_LT(evidence(data, 2, 1), 1e-6);
}

/// Two base columns that differ by a hair: along their difference the fit has left a misfit, as of
/// a flat body's tilt under one camera. A hypothesis that the base can make, but for that hair, was
/// credited with all of it.
TEST(Evidence, WhatAFitLeftUndoneIsNoEvidence) {
  std::mt19937 engine(10);
  Data data = noise(engine, 200, 3);
  const VectorXd hair = data.J.col(1);
  data.J.col(1) = data.J.col(0) + 1e-5 * hair;
  data.J.col(2) = data.J.col(0) + 1e-4 * hair;
  data.r -= hair;
  const MatrixXd H = data.J.transpose() * data.J;
  const auto projected = project(H, 2, {2, 1, VectorXd::Ones(1)});
  const VectorXd s = data.J.transpose() * data.r;
  EXPECT_EQ(log_evidence(projected, s, data.r.squaredNorm(), 200.0, 1.0), 0.0);
  EXPECT_EQ(projected.step(s)[0], 0.0);
  EXPECT_EQ(projected.inverse()(0, 0), 0.0);
}

TEST(Evidence, StepIsTheLeastSquaresStep) {
  std::mt19937 engine(8);
  const Data data = noise(engine, 100, 5);
  const MatrixXd H = data.J.transpose() * data.J;
  const VectorXd s = data.J.transpose() * data.r;
  const VectorXd whole = -H.ldlt().solve(s);
  const auto projected = project(H, 2, {2, 3, VectorXd::Ones(3), false});
  EXPECT_LT((projected.step(s) - whole.tail(3)).norm(), 1e-9 * whole.norm());
  const VectorXd base = H.topLeftCorner(2, 2).ldlt().solve(s.head(2));
  EXPECT_NEAR(projected.fall(s), s.dot(-whole) - s.head(2).dot(base), 1e-9);
  EXPECT_LT((projected.inverse() - H.inverse().bottomRightCorner(3, 3)).norm(), 1e-12);
}

TEST(Evidence, OneSidedParametersDoNotShrink) {
  std::mt19937 engine(9);
  Data data = noise(engine, 200, 2);
  data.r -= 1.0 * data.J.col(1);
  EXPECT_GT(evidence(data, 1, 1, true), 10.0);
  data.r += 2.0 * data.J.col(1);  // the parameter would have to be negative
  EXPECT_EQ(evidence(data, 1, 1, true), 0.0);
  EXPECT_GT(evidence(data, 1, 1, false), 10.0);
}

TEST(Evidence, LogMeanExp) {
  EXPECT_NEAR(log_mean_exp(Eigen::Vector2d(1000.0, 1000.0)), 1000.0, 1e-12);
  EXPECT_NEAR(log_mean_exp(Eigen::Vector2d(0.0, 1000.0)), 1000.0 - std::log(2.0), 1e-9);
}

}  // namespace
}  // namespace hookeye
