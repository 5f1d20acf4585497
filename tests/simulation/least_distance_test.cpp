// Least distance programs: optimal, within, also between almost parallel planes.
#include "simulation/laws/least_distance.h"

#include <gtest/gtest.h>

#include <random>

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Program {
  MatrixXd M, G;
  VectorXd target, h;
};

/// Planes about a ball around the origin, every second one almost a copy of the one before.
Program drawn(int n, int m, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const auto fill = [&](auto&& to) {
    for (double& v : to.reshaped()) v = normal(engine);
  };
  Program p{MatrixXd(n, n), MatrixXd(m, n), VectorXd(n), VectorXd::Constant(m, -1.0)};
  fill(p.M);
  p.M = p.M * p.M.transpose() + 1e-6 * MatrixXd::Identity(n, n);
  fill(p.G);
  fill(p.target);
  p.target *= 5.0;
  for (int k = 1; k < m; k += 2) {
    VectorXd other(n);
    fill(other);
    p.G.row(k) = p.G.row(k - 1) + 1e-7 * other.transpose();
  }
  p.G.rowwise().normalize();
  return p;
}

TEST(LeastDistance, IsOptimalAmongAllPointsWithin) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Program p = drawn(12, 150, seed);
    const auto x = nearest_within(p.M.llt(), p.target, p.G, p.h);
    ASSERT_TRUE(x);
    const VectorXd slack = p.G * *x - p.h, pull = p.M * (*x - p.target);
    EXPECT_GE(slack.minCoeff(), -1e-9);
    // Optimal: the pull is a sum of active normals with multipliers that are not negative
    // (Karush, Kuhn and Tucker); found here over all active planes.
    std::vector<Eigen::Index> active;
    for (Eigen::Index k = 0; k < slack.size(); ++k)
      if (slack[k] < 1e-5) active.push_back(k);
    const MatrixXd normals = p.G(active, Eigen::all).transpose();
    const VectorXd u = nonnegative_least_squares(normals, pull);
    EXPECT_GE(u.minCoeff(), 0.0);
    EXPECT_LT((normals * u - pull).norm(), 1e-5 * pull.norm()) << "seed " << seed;
  }
}

TEST(LeastDistance, TheTargetItselfWhereItIsWithin) {
  Program p = drawn(5, 10, 1);
  p.target *= 1e-3;
  EXPECT_EQ(nearest_within(p.M.llt(), p.target, p.G, p.h)->norm(), p.target.norm());
}

TEST(LeastDistance, NothingWithinIsTold) {
  Program p = drawn(3, 2, 1);
  p.G.row(1) = -p.G.row(0);
  p.h.setConstant(1.0);  // g x >= 1 and -g x >= 1
  EXPECT_FALSE(nearest_within(p.M.llt(), p.target, p.G, p.h));
}

TEST(LeastDistance, NonnegativeLeastSquaresStopsAtZero) {
  const MatrixXd E = (MatrixXd(3, 2) << 1, 1, 0, 1, 0, 0).finished();
  const VectorXd u = nonnegative_least_squares(E, Eigen::Vector3d(1, -2, 7));
  EXPECT_NEAR(u[0], 1.0, 1e-14);
  EXPECT_EQ(u[1], 0.0);
}

}  // namespace
}  // namespace hookeye
