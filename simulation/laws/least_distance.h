// Quadratic programs of a few dozen unknowns.
#pragma once

#include <Eigen/Dense>
#include <optional>

namespace hookeye {

/// u >= 0 with least |E u - f|: the active set of Lawson and Hanson, Solving Least Squares Problems
/// (1974), chapter 23. Ends after at most 3 columns of E changes of the set.
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& E, const Eigen::VectorXd& f);

/// x with least (x - target)^T M (x - target) within G x >= h, M given by its factor; by the dual,
/// which is a nonnegative least squares problem (the same book, LDP). Empty: nothing is within.
std::optional<Eigen::VectorXd> nearest_within(const Eigen::LLT<Eigen::MatrixXd>& M,
                                              const Eigen::VectorXd& target,
                                              const Eigen::MatrixXd& G, const Eigen::VectorXd& h);

}  // namespace hookeye
