// Derivatives are trusted only against finite differences of the real thing.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <functional>

namespace hookeye::test {

/// Compares `analytic` (rows = outputs, one column) with the fourth-order central difference of `f`
/// at 0 with step h. Fails when both are zero: a derivative test on zeros proves nothing.
inline void expect_derivative(const std::function<Eigen::VectorXd(double)>& f,
                              const Eigen::VectorXd& analytic, double h, double relative,
                              const std::string& what = "") {
  const Eigen::VectorXd numeric = (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h);
  const double scale = numeric.norm();
  ASSERT_TRUE(numeric.allFinite()) << what << ": the finite difference is not finite";
  ASSERT_GT(scale, 0.0) << what << ": the derivative vanishes, the test would prove nothing";
  ASSERT_EQ(numeric.size(), analytic.size()) << what;
  EXPECT_LE((numeric - analytic).norm(), relative * scale)
      << what << ": analytic norm " << analytic.norm() << ", finite difference " << scale;
}

}  // namespace hookeye::test
