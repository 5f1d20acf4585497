#include "estimation/evaluation/gram.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace hookeye {

namespace {

/// Root of the least square sum that is told from zero.
constexpr double kNothing = 1e-150;

/// Eigen-decomposition H = D V diag(values) V^T D over scales D (the roots of the diagonal):
/// columns of different units differ by many powers of ten, and what a plain decomposition calls
/// rounding of the large ones drowns the small ones. A column of zeros has no unit: eigenvectors
/// are zero there to rounding alone, which no power of ten may scale.
struct GramEigen {
  Eigen::VectorXd scale, unit, values;  ///< D, its inverse (0 where a column is); ascending
  Eigen::MatrixXd V;

  explicit GramEigen(const Eigen::MatrixXd& H) : GramEigen(H, lengths(H)) {}
  GramEigen(const Eigen::MatrixXd& H, const Eigen::VectorXd& scales)
      : scale(scales), unit((scale.array() > kNothing).select(scale.cwiseInverse(), 0.0)) {
    if (H.size() == 0) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.asDiagonal() * H *
                                                               unit.asDiagonal());
    values = eigen.eigenvalues();
    V = eigen.eigenvectors();
  }
};

}  // namespace

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& H) {
  const GramEigen of(H);
  Eigen::VectorXd inverse = of.values;
  for (double& x : inverse) x = x > kInverted ? 1.0 / x : 0.0;
  const Eigen::MatrixXd back = of.unit.asDiagonal() * of.V;
  return back * inverse.asDiagonal() * back.transpose();
}

Eigen::VectorXd lengths(const Eigen::MatrixXd& H) { return H.diagonal().cwiseMax(0.0).cwiseSqrt(); }

Eigen::MatrixXd square_root(const Eigen::MatrixXd& H, const Eigen::VectorXd& scale,
                            const Eigen::VectorXd& towards) {
  if (H.size() == 0) return H;
  const GramEigen of(H, scale);
  const Eigen::VectorXd side = of.V.transpose() * of.unit.cwiseProduct(towards);
  const Eigen::VectorXd root = of.values.cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd rising =
      of.V * (side.array() < 0.0).select(-root, root).matrix().asDiagonal();
  // A column far shorter than its scale is rounding of the others there. All roots of H are
  // rotations of one another: the one that is exact in each column's own length is turned into
  // this.
  const GramEigen own(H);
  const Eigen::MatrixXd exact =
      own.scale.asDiagonal() * own.V * own.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::BDCSVD<Eigen::MatrixXd> turn(
      (of.unit.asDiagonal() * exact).transpose() * rising.rowwise().reverse(),
      Eigen::ComputeFullU | Eigen::ComputeFullV);
  return exact * (turn.matrixU() * turn.matrixV().transpose());
}

}  // namespace hookeye
