#include <Eigen/Dense>
#include <algorithm>

#include "core/work_clock.h"
#include "simulation/krylov.h"
#include "simulation/problem.h"

namespace hookeye {
namespace {

/// |r| over |B|: what differences of solved equilibria can tell.
constexpr double kTolerance = 1e-9;
/// Right-hand sides that are solved together.
constexpr size_t kBlock = 32;

/// X = K_ff^-1 B with the true tangent.
void solve(const Equilibrium& equilibrium, const MatrixXd& B, MatrixXd& X) {
  const TangentFactor& factor = *equilibrium.factor;
  if (equilibrium.W_ff.nonZeros() == 0) {
    factor.solve(B, X);
    return;
  }
  if (factor.positive() && skew_gradients(equilibrium.W_ff, factor, B, kTolerance, 200, X) >= 0)
    return;
  X.resize(B.rows(), B.cols());
  VectorXd one;  // past a point of instability H is indefinite
  for (Eigen::Index k = 0; k < B.cols(); ++k) {
    if (gmres(equilibrium.K, factor, B.col(k), kTolerance, 500, one) >= 0) {
      X.col(k) = one;
      continue;
    }
    // At a fold S is not there to be had; a step along the symmetric part's is tried all the same.
    MatrixXd symmetric;
    factor.solve(B.col(k), symmetric);
    X.col(k) = symmetric;
  }
}

}  // namespace

MatrixXd sensitivities(const Equilibrium& equilibrium, const Loading& loading,
                       const MatrixXd& dR_dp, const MatrixXd& dqc_dp) {
  const Working part(WorkPart::sensitivities);
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
  // A block at a time: of a hundred columns all right-hand sides are as large as S.
  MatrixXd B, X;
  for (size_t first = 0; first < moving.size(); first += kBlock) {
    const size_t last = std::min(first + kBlock, moving.size());
    const std::vector<Eigen::Index> block(moving.begin() + static_cast<std::ptrdiff_t>(first),
                                          moving.begin() + static_cast<std::ptrdiff_t>(last));
    B = -dR_dp(free, block);
    for (size_t k = 0; k < block.size(); ++k)
      if (moves_support(block[k])) {
        const VectorXd by_support = equilibrium.K * S.col(block[k]);
        B.col(static_cast<Eigen::Index>(k)) -= by_support(free);
      }
    solve(equilibrium, B, X);
    S(free, block) = X;
  }
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
