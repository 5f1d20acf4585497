#include "simulation/petsc/smoother.h"

#include <Eigen/Dense>

namespace hookeye {
namespace {

constexpr int kDegree = 2;
/// Smoothed are the eigenvalues from the largest down to this part of it; the rest is smooth.
constexpr double kSmoothed = 0.1;
/// Steps of Lanczos to the largest eigenvalue, and what they fall short of at most.
constexpr int kLanczos = 12;
constexpr double kMargin = 1.1;

/// Numbers in [-1, 1] that are the same everywhere (splitmix64).
VectorXd noise(Eigen::Index n) {
  VectorXd out(n);
  std::uint64_t state = 1;
  for (double& value : out) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    value = static_cast<double>((z ^ (z >> 31)) >> 11) / 4503599627370496.0 - 1.0;
  }
  return out;
}

}  // namespace

bool Smoother::set_up() {
  values_.assign(K_.values().begin(), K_.values().end());
  inverse_.resize(K_.nodes());
  for (int a = 0; a < K_.nodes(); ++a) {
    const Eigen::Map<const Eigen::Matrix3d> D(K_.values().data() +
                                              9 * static_cast<size_t>(K_.start()[a]));
    const Eigen::LLT<Eigen::Matrix3d> factor(D);
    if (factor.info() != Eigen::Success || !D.allFinite()) return false;
    inverse_[a] = factor.solve(Eigen::Matrix3d::Identity());
  }
  return find_largest();
}

double Smoother::bytes() const {
  return static_cast<double>(values_.size()) * sizeof(float) +
         static_cast<double>(inverse_.size()) * sizeof(Eigen::Matrix3d);
}

template <int M>
Vectors<M> Smoother::by_nodes(const Vectors<M>& r) const {
  Vectors<M> z(M, r.cols());
  for (size_t a = 0; a < inverse_.size(); ++a) {
    const auto at = 3 * static_cast<Eigen::Index>(a);
    z.template middleCols<3>(at).noalias() = r.template middleCols<3>(at).lazyProduct(inverse_[a]);
  }
  return z;
}

/// From the coefficients of conjugate gradients (Saad, 6.7.3).
bool Smoother::find_largest() {
  Vectors<1> r = noise(3 * K_.nodes()).transpose(), z = by_nodes<1>(r), p = z, Kp;
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(kLanczos, kLanczos);
  double rz = r.dot(z), last_alpha = 1.0, beta = 0.0;
  int steps = 0;
  while (steps < kLanczos && rz > 0) {
    K_.multiply<float, 1>(values_, p, Kp);
    const double curvature = p.dot(Kp);
    if (!(curvature > 0)) return false;
    const double alpha = rz / curvature;
    T(steps, steps) = 1 / alpha + (steps > 0 ? beta / last_alpha : 0.0);
    r -= alpha * Kp;
    z = by_nodes<1>(r);
    const double next = r.dot(z);
    beta = next / rz;
    if (++steps < kLanczos) T(steps, steps - 1) = T(steps - 1, steps) = std::sqrt(beta) / alpha;
    p = z + beta * p;
    rz = next;
    last_alpha = alpha;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(T.topLeftCorner(steps, steps));
  largest_ = kMargin * eigen.eigenvalues()[steps - 1];
  return std::isfinite(largest_);
}

template <int M>
void Smoother::polynomial(Vectors<M>& r, Vectors<M>& z, bool residual_after) const {
  const double theta = 0.5 * (1 + kSmoothed) * largest_, delta = 0.5 * (1 - kSmoothed) * largest_;
  const double sigma = theta / delta;
  double rho = 1 / sigma;
  Vectors<M> d = by_nodes<M>(r) / theta;
  z += d;
  for (int k = 1; k < kDegree; ++k) {
    take_off<M>(d, r);
    const double next = 1 / (2 * sigma - rho);
    d = (next * rho) * d + (2 * next / delta) * by_nodes<M>(r);
    z += d;
    rho = next;
  }
  if (residual_after) take_off<M>(d, r);
}

template <int M>
void Smoother::smooth(Vectors<M>& r, Vectors<M>& z) const {
  z.setZero(M, r.cols());
  polynomial<M>(r, z, true);
}

template <int M>
void Smoother::smooth_again(Vectors<M>& r, Vectors<M>& z) const {
  polynomial<M>(r, z, false);
}

template void Smoother::smooth<1>(Vectors<1>&, Vectors<1>&) const;
template void Smoother::smooth<4>(Vectors<4>&, Vectors<4>&) const;
template void Smoother::smooth_again<1>(Vectors<1>&, Vectors<1>&) const;
template void Smoother::smooth_again<4>(Vectors<4>&, Vectors<4>&) const;

}  // namespace hookeye
