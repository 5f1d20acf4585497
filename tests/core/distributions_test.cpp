#include "core/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace hookeye {
namespace {

/// Tables of Abramowitz and Stegun, 26.8 and 26.10, to their digits.
TEST(Distributions, StudentsQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_quantile(0.975, 1), 12.706, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 2), 4.303, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 3), 3.182, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 9), 2.262, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 120), 1.980, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 1e9), 1.960, 5e-4);
  EXPECT_NEAR(student_quantile(0.999, 2), 22.327, 5e-4);
  EXPECT_EQ(student_quantile(0.5, 3), 0.0);
}

/// Between the table's rows: one degree and two have closed forms, tan and a root.
TEST(Distributions, StudentsQuantilesFollowTheirClosedForms) {
  for (const double p : {0.6, 0.9, 0.975, 0.999}) {
    EXPECT_NEAR(student_quantile(p, 1) / std::tan(M_PI * (p - 0.5)), 1.0, 1e-12);
    const double a = 2.0 * p - 1.0;
    EXPECT_NEAR(student_quantile(p, 2) / (a * std::sqrt(2.0 / (1.0 - a * a))), 1.0, 1e-12);
  }
  double last = student_quantile(0.975, 1.0);
  for (double degrees = 1.1; degrees < 4.0; degrees += 0.1) {
    EXPECT_LT(student_quantile(0.975, degrees), last);
    last = student_quantile(0.975, degrees);
  }
}

TEST(Distributions, Chi2QuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(chi2_quantile(0.999, 1), 10.828, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.999, 2), 13.816, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.999, 30), 59.703, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.95, 10), 18.307, 5e-4);
  EXPECT_NEAR(chi2_quantile(0.2, 2), 2.0 * std::log(1.25), 1e-12);
  EXPECT_NEAR(chi2_quantile(0.999, 1e6) / 1e6, 1.0 + 3.0902 * std::sqrt(2e-6), 1e-5);
  EXPECT_EQ(chi2_quantile(0.999, 0), 0.0);
}

TEST(Distributions, DegreesThatCannotBeAreAnError) {
  EXPECT_THROW(student_quantile(0.975, 0.0), std::domain_error);
  EXPECT_THROW(chi2_quantile(0.999, -1.0), std::domain_error);
  EXPECT_THROW(chi2_quantile(0.999, std::nan("")), std::domain_error);
}

}  // namespace
}  // namespace hookeye
