#include "simulation/ellipticity.h"

#include <Eigen/Eigenvalues>
#include <cmath>

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

}  // namespace

Ellipticity ellipticity(const Matrix9d& D, int starts) {
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
      const Eigen::SelfAdjointEigenSolver<Matrix3d> first(by_n(D, n));
      m = first.eigenvectors().col(0);
      const Matrix3d A = by_m(D, m);
      const Eigen::SelfAdjointEigenSolver<Matrix3d> second(0.5 * (A + A.transpose()));
      n = second.eigenvectors().col(0);
      const double now = second.eigenvalues()[0];
      const bool settled = value - now <= 1e-10 * D.norm();
      value = now;
      if (settled) break;
    }
    if (value < best.smallest) best = {value, m, n};
  }
  return best;
}

}  // namespace hookeye
