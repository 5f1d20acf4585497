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
/// A with A A^T = H: columns along the eigenvectors of H in units of `scale` (of each column's own
/// order; 0: it says nothing), by falling eigenvalue, each on the side of `towards`. If H, `scale`
/// and `towards` are told in other columns, by a rotation of those of one scale or in another
/// order, so is A: what is drawn with it is drawn in any frame.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& H, const Eigen::VectorXd& scale,
                            const Eigen::VectorXd& towards);
/// Roots of the diagonal of H.
Eigen::VectorXd lengths(const Eigen::MatrixXd& H);

}  // namespace hookeye
