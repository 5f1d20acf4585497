#include "estimation/model/strain_measure.h"

#include <algorithm>
#include <cmath>

namespace hookeye {

namespace {

/// A strain as a function of (C11, C22, C12), with its derivative.
struct OfMetric {
  Vector3d e;
  Eigen::Matrix3d d_C;
};

OfMetric green(const Eigen::Matrix2d& C) {
  return {{0.5 * (C(0, 0) - 1.0), 0.5 * (C(1, 1) - 1.0), 0.5 * C(0, 1)},
          0.5 * Eigen::Matrix3d::Identity()};
}

OfMetric engineering(const Eigen::Matrix2d& C) {
  const double x = std::sqrt(C(0, 0)), y = std::sqrt(C(1, 1));
  const double sine = std::clamp(C(0, 1) / (x * y), -1.0, 1.0);
  const double half = 0.5 / std::sqrt(std::max(1.0 - sine * sine, 1e-300));
  OfMetric out{{x - 1.0, y - 1.0, 0.5 * std::asin(sine)}, Eigen::Matrix3d::Zero()};
  out.d_C(0, 0) = 0.5 / x, out.d_C(1, 1) = 0.5 / y;
  out.d_C.row(2) << -0.5 * half * sine / C(0, 0), -0.5 * half * sine / C(1, 1), half / (x * y);
  return out;
}

/// g of the eigenvalues and (g(a) - g(b))/(a - b), exact where they meet.
struct Log {
  static double of(double a) { return 0.5 * std::log(a); }
  static double slope(double a, double b) {
    const double x = a / b - 1.0;
    return 0.5 / b * (std::abs(x) < 1e-8 ? 1.0 - 0.5 * x : std::log1p(x) / x);
  }
};
struct Root {
  static double of(double a) { return std::sqrt(a) - 1.0; }
  static double slope(double a, double b) { return 1.0 / (std::sqrt(a) + std::sqrt(b)); }
};

/// Derivative by the rule of Daleckii and Krein.
template <class Function>
OfMetric by_stretches(const Eigen::Matrix2d& C) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(C);
  const Eigen::Matrix2d Q = eigen.eigenvectors();
  const Eigen::Vector2d c = eigen.eigenvalues().cwiseMax(1e-300);
  const Eigen::Matrix2d E =
      Q * Eigen::Vector2d(Function::of(c[0]), Function::of(c[1])).asDiagonal() * Q.transpose();
  Eigen::Matrix2d slopes;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) slopes(i, j) = Function::slope(c[i], c[j]);
  OfMetric out{{E(0, 0), E(1, 1), E(0, 1)}, {}};
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix2d dC = Eigen::Matrix2d::Zero();
    if (k < 2)
      dC(k, k) = 1.0;
    else
      dC(0, 1) = dC(1, 0) = 1.0;
    const Eigen::Matrix2d dE = Q * slopes.cwiseProduct(Q.transpose() * dC * Q) * Q.transpose();
    out.d_C.col(k) << dE(0, 0), dE(1, 1), dE(0, 1);
  }
  return out;
}

OfMetric of_metric(StrainMeasure measure, const Eigen::Matrix2d& C) {
  switch (measure) {
    case StrainMeasure::hencky:
      return by_stretches<Log>(C);
    case StrainMeasure::biot:
      return by_stretches<Root>(C);
    case StrainMeasure::engineering:
      return engineering(C);
    default:
      return green(C);
  }
}

}  // namespace

StrainOfTangents strain_by(StrainMeasure measure, const Tangents& A, const Tangents& T) {
  StrainOfTangents out;
  if (measure == StrainMeasure::small) {
    const Eigen::Matrix2d G = T.transpose() * (A - T);
    out.e << G(0, 0), G(1, 1), 0.5 * (G(0, 1) + G(1, 0));
    out.d_A.block<1, 3>(0, 0) = T.col(0).transpose();
    out.d_A.block<1, 3>(1, 3) = T.col(1).transpose();
    out.d_A.block<1, 3>(2, 0) = 0.5 * T.col(1).transpose();
    out.d_A.block<1, 3>(2, 3) = 0.5 * T.col(0).transpose();
    return out;
  }
  const OfMetric of = of_metric(measure, A.transpose() * A);
  Eigen::Matrix<double, 3, 6> dC = Eigen::Matrix<double, 3, 6>::Zero();
  dC.block<1, 3>(0, 0) = 2.0 * A.col(0).transpose();
  dC.block<1, 3>(1, 3) = 2.0 * A.col(1).transpose();
  dC.block<1, 3>(2, 0) = A.col(1).transpose();
  dC.block<1, 3>(2, 3) = A.col(0).transpose();
  out.e = of.e;
  out.d_A = of.d_C * dC;
  return out;
}

}  // namespace hookeye
