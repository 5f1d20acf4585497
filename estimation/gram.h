// Gram matrices (J^T J, covariances) whose columns have any units.
#pragma once

#include <Eigen/Core>

namespace hookeye {

/// Eigenvalues up to this, of columns of length one, are taken for zero by pseudo_inverse: of a
/// double's sixteen digits a decomposition of some hundred columns leaves fourteen, and the inverse
/// keeps six.
constexpr double kInverted = 1e-8;

/// H^+.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& H);
/// A with A A^T = H.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& H);

}  // namespace hookeye
