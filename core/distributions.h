// Quantiles of the distributions that tests and intervals stand on.
#pragma once

namespace hookeye {

/// Student's t: the value that it stays below with `probability`, in (0, 1). `degrees` > 0 of
/// freedom, whole or not.
double student_quantile(double probability, double degrees);

/// Half a 95 % interval of a normal distribution, in standard deviations.
constexpr double kNormal95 = 1.959964;

/// Quantile of chi^2; 0 for no degrees of freedom.
double chi2_quantile(double probability, double degrees);

}  // namespace hookeye
