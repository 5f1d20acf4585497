#include "capture_io/light_harmonics.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace hookeye {

namespace {

/// The cosine about the normal keeps 1, 2/3 and 1/4 of the orders 0, 1 and 2 (over pi), each times
/// what normalises its harmonics.
const double kFirst = 2.0 / 3.0 * std::sqrt(3.0 / (4.0 * EIGEN_PI));
const double kMixed = 1.0 / 4.0 * std::sqrt(15.0 / (4.0 * EIGEN_PI));  // xy, yz, xz
const double kAxial = 1.0 / 4.0 * std::sqrt(5.0 / (16.0 * EIGEN_PI));  // 3 zz - 1
const double kPlane = kMixed / 2.0;                                    // xx - yy

double least_of(double mean, const Eigen::Vector3d& b, const Eigen::Matrix3d& Q) {
  // A quadratic on the sphere: its least value is the greatest of the concave
  // m - sum_i g_i^2 / (4 (q_i - m)) over m up to the least eigenvalue (strong duality, one
  // constraint), where the slope 1 - sum_i g_i^2 / (4 (q_i - m)^2) is zero or m is at the end.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(Q);
  const Eigen::Vector3d q = eigen.eigenvalues(), g = eigen.eigenvectors().transpose() * b;
  const auto sum = [&](double m, int power) {
    double out = 0.0;
    for (int i = 0; i < 3; ++i)
      if (g[i] != 0.0) out += g[i] * g[i] / (4.0 * std::pow(q[i] - m, power));
    return out;
  };
  double low = q[0] - b.norm() / 2.0, high = q[0];  // at `low` no term exceeds its share of 1
  if (low == high) return mean + low;
  for (int i = 0; i < 100; ++i) {
    const double m = (low + high) / 2.0;
    if (m <= low || m >= high) break;
    (sum(m, 2) < 1.0 ? low : high) = m;
  }
  return mean + low - sum(low, 1);
}

}  // namespace

const std::array<const char*, 1 + kUnevenNumbers> harmonic_names = {
    "L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22"};

const double even_by_harmonic = std::sqrt(1.0 / (4.0 * EIGEN_PI));

Irradiance::Irradiance(double even, const UnevenLight& L) : mean(even) {
  b = kFirst * Eigen::Vector3d(L[2], L[0], L[1]);
  const double xy = kMixed * L[3] / 2.0, yz = kMixed * L[4] / 2.0, xz = kMixed * L[6] / 2.0;
  const double axial = kAxial * L[5], plane = kPlane * L[7];
  Q << plane - axial, xy, xz, xy, -plane - axial, yz, xz, yz, 2.0 * axial;
}

double Irradiance::least() const { return least_of(mean, b, Q); }
double Irradiance::most() const { return -least_of(-mean, -b, -Q); }

UnevenLight irradiance_by_uneven(const Eigen::Vector3d& n) {
  UnevenLight out;
  out << kFirst * n.y(), kFirst * n.z(), kFirst * n.x(), kMixed * n.x() * n.y(),
      kMixed * n.y() * n.z(), kAxial * (3.0 * n.z() * n.z() - n.squaredNorm()),
      kMixed * n.x() * n.z(), kPlane * (n.x() * n.x() - n.y() * n.y());
  return out;
}

UnevenLight turned(const UnevenLight& light, const Eigen::Matrix3d& R) {
  const Irradiance before(0.0, light);
  const Eigen::Vector3d b = R * before.b;
  const Eigen::Matrix3d Q = R * before.Q * R.transpose();
  UnevenLight out;
  out << b.y() / kFirst, b.z() / kFirst, b.x() / kFirst, 2.0 * Q(0, 1) / kMixed,
      2.0 * Q(1, 2) / kMixed, Q(2, 2) / (2.0 * kAxial), 2.0 * Q(0, 2) / kMixed,
      (Q(0, 0) - Q(1, 1)) / (2.0 * kPlane);
  return out;
}

}  // namespace hookeye
