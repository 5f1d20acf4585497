// Gram matrices (J^T J, covariances) whose columns have any units.
#pragma once

#include <Eigen/Core>

namespace hookeye {

/// Eigen-decomposition H = D V diag(values) V^T D over the roots D of the diagonal: columns of
/// different units differ by many powers of ten, and what a plain decomposition calls rounding of
/// the large ones drowns the small ones.
struct GramEigen {
  Eigen::VectorXd scale;   ///< D, at least 1e-150
  Eigen::VectorXd values;  ///< ascending; their sum is the number of columns
  Eigen::MatrixXd V;

  explicit GramEigen(const Eigen::MatrixXd& H);
};

/// Eigenvalues (GramEigen) up to this are taken for zero by pseudo_inverse: of a double's sixteen
/// digits a decomposition of some hundred columns leaves fourteen, and the inverse keeps six.
constexpr double kInverted = 1e-8;

/// H^+.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& H);
/// A with A A^T = H.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& H);

}  // namespace hookeye
