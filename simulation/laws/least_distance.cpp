#include "simulation/laws/least_distance.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace hookeye {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The least squares solution over the columns of `set`, zero elsewhere.
VectorXd solve_over(const MatrixXd& E, const VectorXd& f, const std::vector<Eigen::Index>& set) {
  VectorXd z = VectorXd::Zero(E.cols());
  if (!set.empty()) z(set) = MatrixXd(E(Eigen::all, set)).colPivHouseholderQr().solve(f);
  return z;
}

/// From u towards z until the first value would pass zero, which leaves the set.
void step_to_boundary(const VectorXd& z, VectorXd& u, std::vector<Eigen::Index>& set) {
  double alpha = 1.0;
  for (const Eigen::Index k : set)
    if (z[k] <= 0) alpha = std::min(alpha, u[k] / (u[k] - z[k]));
  const VectorXd there = u + alpha * (z - u);
  std::erase_if(set, [&](Eigen::Index k) {
    return z[k] <= 0 && there[k] <= 1e-14 * std::max(1.0, u.maxCoeff());
  });
  u.setZero();
  for (const Eigen::Index k : set) u[k] = there[k];
}

}  // namespace

VectorXd nonnegative_least_squares(const MatrixXd& E, const VectorXd& f) {
  VectorXd u = VectorXd::Zero(E.cols());
  std::vector<Eigen::Index> set;
  // Rounding leaves the columns of the set a little away from orthogonal to the residual.
  const double tiny = 1e-13 * f.norm();
  const VectorXd lengths = E.colwise().norm().transpose().cwiseMax(1e-300);
  for (Eigen::Index change = 0; change < 3 * E.cols(); ++change) {
    VectorXd w = (E.transpose() * (f - E * u)).cwiseQuotient(lengths);
    for (const Eigen::Index k : set) w[k] = 0.0;
    VectorXd z;
    while (true) {  // a column that rounding alone lets in is passed over
      Eigen::Index j = 0;
      if (!(w.maxCoeff(&j) > tiny)) return u;
      set.push_back(j);
      z = solve_over(E, f, set);
      if (z[j] > 0) break;
      set.pop_back();
      w[j] = 0.0;
    }
    while (std::any_of(set.begin(), set.end(), [&](Eigen::Index k) { return z[k] <= 0; })) {
      step_to_boundary(z, u, set);
      z = solve_over(E, f, set);
    }
    u = z;
  }
  return u;
}

std::optional<VectorXd> nearest_within(const Eigen::LLT<MatrixXd>& M, const VectorXd& target,
                                       const MatrixXd& G, const VectorXd& h) {
  // y = L^T (x - target): least |y| with N^T y >= b, rows of length one.
  MatrixXd N = M.matrixL().solve(G.transpose());
  VectorXd b = h - G * target;
  for (Eigen::Index k = 0; k < b.size(); ++k) {
    const double length = N.col(k).norm();
    if (!(length > 0)) continue;
    N.col(k) /= length;
    b[k] /= length;
  }
  const double size = b.maxCoeff();
  if (!(size > 0)) return target;
  MatrixXd E(N.rows() + 1, N.cols());
  E << N, b.transpose() / size;
  const VectorXd u = nonnegative_least_squares(E, VectorXd::Unit(E.rows(), E.rows() - 1));
  const double left = 1.0 - E.bottomRows<1>().dot(u);
  if (!(left > std::numeric_limits<double>::epsilon())) return std::nullopt;
  return target + M.matrixU().solve(size / left * (N * u));
}

}  // namespace hookeye
