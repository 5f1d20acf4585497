#include <Eigen/Dense>

#include "simulation/problem.h"
#include "simulation/sparse_factor.h"

namespace hookeye {

MatrixXd sensitivities(const Equilibrium& equilibrium, const Loading& loading,
                       const MatrixXd& dR_dp, const MatrixXd& dqc_dp) {
  const std::vector<int>& free = equilibrium.factor->free();
  MatrixXd S = MatrixXd::Zero(dR_dp.rows(), dR_dp.cols());
  MatrixXd rhs = dR_dp;
  if (dqc_dp.size()) {
    for (size_t i = 0; i < loading.prescribed.size(); ++i)
      S.row(loading.prescribed[i]) = dqc_dp.row(static_cast<Eigen::Index>(i));
    rhs += equilibrium.K * S;
  }
  const MatrixXd B = -rhs(free, Eigen::all);
  MatrixXd X;
  equilibrium.factor->solve(B, X);
  S(free, Eigen::all) = X;
  return S;
}

Vector3d support_force(const Equilibrium& equilibrium, const Region& region) {
  Vector3d f = Vector3d::Zero();
  for (int a : region.nodes) f += equilibrium.R.segment<3>(3 * a);
  return f;
}

Vector3d support_moment(const Equilibrium& equilibrium, const Region& region,
                        const Vector3d& about) {
  Vector3d m = Vector3d::Zero();
  for (int a : region.nodes)
    m += (equilibrium.q.segment<3>(3 * a) - about).cross(equilibrium.R.segment<3>(3 * a));
  return m;
}

MatrixXd d_support_force(const Region& region, const MatrixXd& dR) {
  MatrixXd d = MatrixXd::Zero(3, dR.cols());
  for (int a : region.nodes) d += dR.middleRows<3>(3 * a);
  return d;
}

MatrixXd d_support_moment(const Equilibrium& equilibrium, const Region& region,
                          const Vector3d& about, const MatrixXd& dR, const MatrixXd& S) {
  MatrixXd d = MatrixXd::Zero(3, dR.cols());
  for (int a : region.nodes) {
    const Vector3d arm = equilibrium.q.segment<3>(3 * a) - about,
                   R = equilibrium.R.segment<3>(3 * a);
    for (Eigen::Index j = 0; j < dR.cols(); ++j)
      d.col(j) += arm.cross(Vector3d(dR.col(j).segment<3>(3 * a))) +
                  Vector3d(S.col(j).segment<3>(3 * a)).cross(R);
  }
  return d;
}

}  // namespace hookeye
