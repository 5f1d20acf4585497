#include "simulation/ellipticity.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <utility>

namespace hookeye {
namespace {

/// (acoustic tensor)_ik = n_a D_(ia)(kb) n_b.
Matrix3d by_n(const Matrix9d& D, const Eigen::Vector3d& n) {
  Matrix3d A = Matrix3d::Zero();
  for (int b = 0; b < 3; ++b)
    for (int a = 0; a < 3; ++a) A += n[a] * n[b] * D.block<3, 3>(3 * a, 3 * b);
  return A;
}
/// The same with m told: a quadratic form in n.
Matrix3d by_m(const Matrix9d& D, const Eigen::Vector3d& m) {
  Matrix3d A;
  for (int b = 0; b < 3; ++b)
    for (int a = 0; a < 3; ++a) A(a, b) = m.dot(D.block<3, 3>(3 * a, 3 * b) * m);
  return A;
}

/// Smallest eigenvalue and its direction.
std::pair<double, Eigen::Vector3d> smallest(const Matrix3d& A, bool roughly) {
  Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
  if (roughly)
    eigen.computeDirect(A);
  else
    eigen.compute(A);
  return {eigen.eigenvalues()[0], eigen.eigenvectors().col(0)};
}

}  // namespace

Ellipticity ellipticity(const Matrix9d& D, int starts, bool roughly) {
  // From directions spread over the half sphere (40: 20 degrees apart), m and n in turn: each is
  // the smallest eigenvector with the other fixed, so the value only falls.
  Ellipticity best;
  best.smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < starts; ++i) {
    const double z = (i + 0.5) / starts, angle = i * EIGEN_PI * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    Eigen::Vector3d n(r * std::cos(angle), r * std::sin(angle), z), m;
    double value = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < 50; ++turn) {
      m = smallest(by_n(D, n), roughly).second;
      const Matrix3d A = by_m(D, m);
      const auto [now, direction] = smallest(0.5 * (A + A.transpose()), roughly);
      n = direction;
      const bool settled = value - now <= (roughly ? 1e-5 : 1e-10) * D.norm();
      value = now;
      if (settled) break;
    }
    if (value < best.smallest) best = {value, m, n};
  }
  return best;
}

}  // namespace hookeye
