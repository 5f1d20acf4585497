#include <Eigen/Dense>
#include <algorithm>

#include "simulation/krylov.h"
#include "simulation/problem.h"

namespace hookeye {
namespace {

/// |r| over |B|: what differences of solved equilibria can tell.
constexpr double kTolerance = 1e-9;
/// Right-hand sides that are refined together.
constexpr Eigen::Index kBlock = 32;

/// X = K_ff^-1 B with the true tangent.
void solve(const Equilibrium& equilibrium, const MatrixXd& B, MatrixXd& X) {
  const TangentFactor& factor = *equilibrium.factor;
  if (equilibrium.W_ff.nonZeros() == 0) {
    factor.solve(B, X);
    return;
  }
  X.resize(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); j += kBlock) {
    const Eigen::Index m = std::min(kBlock, B.cols() - j);
    MatrixXd x;
    if (factor.positive() &&
        skew_gradients(equilibrium.W_ff, factor, B.middleCols(j, m), kTolerance, 200, x) >= 0) {
      X.middleCols(j, m) = x;
      continue;
    }
    VectorXd one;  // past a point of instability H is indefinite
    for (Eigen::Index k = j; k < j + m; ++k) {
      if (gmres(equilibrium.K, factor, B.col(k), kTolerance, 500, one) >= 0) {
        X.col(k) = one;
        continue;
      }
      // At a fold S is not there to be had; a step along the symmetric part's is tried all the
      // same.
      MatrixXd symmetric;
      factor.solve(B.col(k), symmetric);
      X.col(k) = symmetric;
    }
  }
}

}  // namespace

MatrixXd sensitivities(const Equilibrium& equilibrium, const Loading& loading,
                       const MatrixXd& dR_dp, const MatrixXd& dqc_dp) {
  const std::vector<int>& free = equilibrium.factor->free();
  MatrixXd S = MatrixXd::Zero(dR_dp.rows(), dR_dp.cols());
  const auto moves_support = [&](Eigen::Index j) {
    return dqc_dp.size() != 0 && !dqc_dp.col(j).isZero(0.0);
  };
  std::vector<Eigen::Index> moving;  // cameras and other examples' parameters move nothing here
  for (Eigen::Index j = 0; j < S.cols(); ++j)
    if (moves_support(j) || !dR_dp.col(j).isZero(0.0)) moving.push_back(j);
  if (moving.empty()) return S;
  for (size_t i = 0; i < loading.prescribed.size() && dqc_dp.size(); ++i)
    S.row(loading.prescribed[i]) = dqc_dp.row(static_cast<Eigen::Index>(i));
  MatrixXd rhs = dR_dp(Eigen::all, moving);
  for (size_t k = 0; k < moving.size(); ++k)
    if (moves_support(moving[k]))
      rhs.col(static_cast<Eigen::Index>(k)) += equilibrium.K * S.col(moving[k]);
  MatrixXd X;
  solve(equilibrium, -rhs(free, Eigen::all), X);
  S(free, moving) = X;
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

namespace {

/// W^T (dR/dp + K S) + by_q^T S, of the few rows that W and by_q have.
MatrixXd of_reactions(const Equilibrium& equilibrium, const Region& region, const MatrixXd& W,
                      const MatrixXd& by_q, const MatrixXd& dR_dp, const MatrixXd& S) {
  const auto summed = [](const MatrixXd& weights, const MatrixXd& of,
                         const std::vector<int>& rows) {
    return (weights(rows, Eigen::all).transpose() * of(rows, Eigen::all)).eval();
  };
  std::vector<int> own, near;
  for (int a : region.nodes)
    for (int i = 0; i < 3; ++i) own.push_back(3 * a + i);
  const MatrixXd by_S = equilibrium.K.transpose() * W + by_q;
  for (int i = 0; i < by_S.rows(); ++i)
    if (!by_S.row(i).isZero(0.0)) near.push_back(i);
  return summed(W, dR_dp, own) + summed(by_S, S, near);
}

}  // namespace

MatrixXd d_support_force(const Equilibrium& equilibrium, const Region& region,
                         const MatrixXd& dR_dp, const MatrixXd& S) {
  MatrixXd W = MatrixXd::Zero(S.rows(), 3);
  for (int a : region.nodes) W.middleRows<3>(3 * a).setIdentity();
  return of_reactions(equilibrium, region, W, MatrixXd::Zero(S.rows(), 3), dR_dp, S);
}

MatrixXd d_support_moment(const Equilibrium& equilibrium, const Region& region,
                          const Vector3d& about, const MatrixXd& dR_dp, const MatrixXd& S) {
  MatrixXd W = MatrixXd::Zero(S.rows(), 3), by_q = W;  // arm x dR + dq x R
  const auto crossed = [](const Vector3d& a) {         // [a]x^T
    Eigen::Matrix3d m;
    m << 0, a.z(), -a.y(), -a.z(), 0, a.x(), a.y(), -a.x(), 0;
    return m;
  };
  for (int a : region.nodes) {
    W.middleRows<3>(3 * a) = crossed(equilibrium.q.segment<3>(3 * a) - about);
    by_q.middleRows<3>(3 * a) = -crossed(equilibrium.R.segment<3>(3 * a));
  }
  return of_reactions(equilibrium, region, W, by_q, dR_dp, S);
}

}  // namespace hookeye
