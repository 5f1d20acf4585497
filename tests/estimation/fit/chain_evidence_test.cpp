// Evidence of whole models against densities that are known exactly, and against frequencies.
#include "estimation/fit/chain_evidence.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Rows {
  MatrixXd J;
  VectorXd r;
};

MatrixXd drawn(std::mt19937& engine, int rows, int columns) {
  std::normal_distribution<double> normal;
  MatrixXd out(rows, columns);
  for (double& x : out.reshaped()) x = normal(engine);
  return out;
}

EffectiveSums sums_of(const Rows& rows) {
  return {rows.J.transpose() * rows.J, rows.J.transpose() * rows.r, rows.r.squaredNorm(),
          static_cast<double>(rows.r.size()), 1.0};
}

/// Normal density, but for N/2 log 2 pi.
double log_density(const VectorXd& x, const MatrixXd& C) {
  const Eigen::LLT<MatrixXd> factor(C);
  return -0.5 * x.dot(factor.solve(x)) - MatrixXd(factor.matrixL()).diagonal().array().log().sum();
}

GaussianPrior prior_of(std::mt19937& engine, int columns) {
  const MatrixXd root = drawn(engine, columns, columns);
  return {drawn(engine, columns, 1), root * root.transpose() + MatrixXd::Identity(columns, columns),
          VectorXd::Constant(columns, std::numeric_limits<double>::infinity())};
}

TEST(ChainEvidence, EqualsTheDensityOfTheDataAndOfTheHeldOutOnesGivenThem) {
  std::mt19937 engine(1);
  const Rows fitted{drawn(engine, 30, 4), drawn(engine, 30, 1)},
      held{drawn(engine, 12, 4), 2.0 * drawn(engine, 12, 1)};
  const GaussianPrior prior = prior_of(engine, 4);
  const double v = 1.3, w = 2.1;
  // r + J d, d ~ N(mean, P^-1): the data are zero there.
  const MatrixXd P = prior.precision.inverse();
  const MatrixXd C = v * MatrixXd::Identity(30, 30) + fitted.J * P * fitted.J.transpose();
  const double exact = log_density(fitted.r + fitted.J * prior.mean, C);
  VectorXd one(1), both(2);
  one << v;
  both << v, w;
  EXPECT_NEAR(log_marginal({sums_of(fitted)}, one, prior), exact, 1e-8);

  // Held out: covariance of noise and J V J^T, about what the fitted values predict.
  const MatrixXd V = (fitted.J.transpose() * fitted.J / v + prior.precision).inverse();
  const VectorXd d = V * (prior.precision * prior.mean - fitted.J.transpose() * fitted.r / v);
  const double predicted = log_density(
      held.r + held.J * d, w * MatrixXd::Identity(12, 12) + held.J * V * held.J.transpose());
  EXPECT_NEAR(log_marginal({sums_of(fitted), sums_of(held)}, both, prior) - exact, predicted, 1e-8);
}

TEST(ChainEvidence, VariancesAreThoseThatSuitAndNeverBelowTheNoise) {
  std::mt19937 engine(2);
  const Rows quiet{drawn(engine, 200, 3), 0.3 * drawn(engine, 200, 1)},
      loud{drawn(engine, 200, 3), 3.0 * drawn(engine, 200, 1)};
  const GaussianPrior prior = prior_of(engine, 3);
  const std::vector<EffectiveSums> groups = {sums_of(quiet), sums_of(loud)};
  const VectorXd variance = suiting_variances(groups, prior);
  EXPECT_EQ(variance[0], 1.0);
  EXPECT_NEAR(variance[1], 9.0, 1.8);
  const double best = log_marginal(groups, variance, prior);
  for (const double factor : {0.9, 1.1}) {
    VectorXd other = variance;
    other[1] *= factor;
    EXPECT_LT(log_marginal(groups, other, prior), best);
  }
}

TEST(ChainEvidence, AOneSidedPriorIsHalfANormalOne) {
  std::mt19937 engine(3);
  for (const double truth : {-0.2, 0.0, 0.1, 0.4}) {
    Rows rows{drawn(engine, 20, 1), drawn(engine, 20, 1)};
    rows.r -= truth * rows.J;
    const double fitted = 0.25, deviation = 0.5;  // r is of the data at the fitted value
    GaussianPrior prior{VectorXd::Constant(1, -fitted), MatrixXd::Constant(1, 1, 4.0),
                        VectorXd::Constant(1, fitted)};
    double sum = 0.0;  // over the value itself, above zero
    const double step = 1e-4;
    for (double t = 0.5 * step; t < 6.0; t += step)
      sum += step * std::exp(-0.5 * (rows.r + (t - fitted) * rows.J).squaredNorm()) * 2.0 *
             std::exp(-0.5 * std::pow(t / deviation, 2)) /
             (deviation * std::sqrt(2.0 * std::numbers::pi));
    EXPECT_NEAR(log_marginal({sums_of(rows)}, VectorXd::Ones(1), prior), std::log(sum), 1e-4);
  }
}

TEST(ChainEvidence, WhatNothingTellsOfCostsNothing) {
  std::mt19937 engine(4);
  const Rows rows{drawn(engine, 40, 2), drawn(engine, 40, 1)};
  const GaussianPrior prior = prior_of(engine, 2);
  Rows wider = rows;
  wider.J.conservativeResize(40, 3);
  wider.J.col(2).setZero();
  GaussianPrior open{VectorXd::Zero(3), MatrixXd::Zero(3, 3),
                     VectorXd::Constant(3, std::numeric_limits<double>::infinity())};
  open.mean.head(2) = prior.mean;
  open.precision.topLeftCorner(2, 2) = prior.precision;
  EXPECT_NEAR(log_marginal({sums_of(wider)}, VectorXd::Ones(1), open),
              log_marginal({sums_of(rows)}, VectorXd::Ones(1), prior), 1e-6);
}

/// Models drawn by the prior and told by their posterior: of those that are told with 70 % seven of
/// ten are right.
TEST(ChainEvidence, ProbabilitiesAreFrequencies) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> even;
  constexpr int kDraws = 3000;
  double told[5] = {}, right[5] = {}, count[5] = {};
  for (int i = 0; i < kDraws; ++i) {
    const MatrixXd J = drawn(engine, 20, 3);
    const bool wide = even(engine) < 0.5;  // of columns 0 and 1, or of column 2
    const VectorXd t = 0.4 * drawn(engine, 3, 1);
    VectorXd r = drawn(engine, 20, 1);
    r -= wide ? VectorXd(J.leftCols(2) * t.head(2)) : VectorXd(J.col(2) * t[2]);
    const auto evidence = [&](const MatrixXd& columns) {
      const auto m = columns.cols();
      const GaussianPrior prior{VectorXd::Zero(m), MatrixXd::Identity(m, m) / 0.16,
                                VectorXd::Constant(m, std::numeric_limits<double>::infinity())};
      return log_marginal({sums_of({columns, r})}, VectorXd::Ones(1), prior);
    };
    const double sure = 1.0 / (1.0 + std::exp(evidence(J.col(2)) - evidence(J.leftCols(2))));
    const int bin = std::min(4, static_cast<int>(5.0 * sure));
    told[bin] += sure, right[bin] += wide, count[bin] += 1.0;
  }
  for (int bin = 0; bin < 5; ++bin) {
    ASSERT_GT(count[bin], 50.0);
    const double sure = told[bin] / count[bin];
    EXPECT_NEAR(right[bin] / count[bin], sure, 3.5 * std::sqrt(sure * (1.0 - sure) / count[bin]));
  }
}

}  // namespace
}  // namespace hookeye
