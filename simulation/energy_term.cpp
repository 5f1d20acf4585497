#include "simulation/energy_model.h"

namespace hookeye {

Eigen::Matrix<double, 9, Eigen::Dynamic> EnergyTerm::all_dP_dtheta(const Matrix3d& F) const {
  Eigen::Matrix<double, 9, Eigen::Dynamic> all(9, size());
  for (int k = 0; k < all.cols(); ++k) all.col(k) = dP_dtheta(F, k).reshaped();
  return all;
}

Matrix9d stiffness_from_frame(const Matrix9d& D, const Matrix3d& A) {
  // dP = dP' A^T and dF' = dF A: block (a, b) = sum_ij A_ai A_bj D_(i, j).
  Matrix9d half = Matrix9d::Zero(), out = Matrix9d::Zero();
  for (int b = 0; b < 3; ++b)
    for (int j = 0; j < 3; ++j) half.middleCols<3>(3 * b) += A(b, j) * D.middleCols<3>(3 * j);
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) out.middleRows<3>(3 * a) += A(a, i) * half.middleRows<3>(3 * i);
  return out;
}

Eigen::Matrix<double, 9, Eigen::Dynamic> EnergyModel::Part::all_dP_dtheta(int e,
                                                                          const Matrix3d& F) const {
  if (frames.size() == 0) return term->all_dP_dtheta(F);
  const Matrix3d A = frame(e);
  Eigen::Matrix<double, 9, Eigen::Dynamic> all = term->all_dP_dtheta(F * A);
  for (Eigen::Index k = 0; k < all.cols(); ++k)
    all.col(k) = (Matrix3d(all.col(k).reshaped(3, 3)) * A.transpose()).eval().reshaped();
  return all;
}

}  // namespace hookeye
