// The additive law's energy, written a second time from its text (simulation/additive.h), for any
// scalar.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "simulation/additive.h"

namespace hookeye::test {

/// The energy written anew from additive.h: values of Psi'' integrated by Simpson's rule over the
/// pieces, exact for the linear integrand times a linear weight.
template <class T>
T curvature(const Addend& a, T x) {
  const auto& at = a.at;
  const auto n = static_cast<int>(at.size());
  if (x <= at.front()) return T(a.stiffness[0]);
  if (x >= at.back()) return T(a.stiffness[n - 1]);
  int i = 0;
  while (x > at[i + 1]) ++i;
  const T t = (x - at[i]) / (at[i + 1] - at[i]);
  return a.stiffness[i] * (1.0 - t) + a.stiffness[i + 1] * t;
}
/// int_0^x (x - s) f(s) ds, by pieces between the points.
template <class T, class F>
T twice_integrated(const std::vector<double>& at, T x, const F& f) {
  std::vector<T> breaks = {T(0.0), x};
  for (double p : at)
    if ((p > 0.0 && p < x) || (p < 0.0 && p > x)) breaks.push_back(T(p));
  std::sort(breaks.begin(), breaks.end(),
            [&](const T& a, const T& b) { return x > 0.0 ? a < b : a > b; });
  T sum(0.0);
  for (size_t i = 0; i + 1 < breaks.size(); ++i) {
    const T a = breaks[i], b = breaks[i + 1], m = 0.5 * (a + b);
    sum += (b - a) / 6.0 * ((x - a) * f(a) + 4.0 * (x - m) * f(m) + (x - b) * f(b));
  }
  return sum;
}
template <class T>
T once_integrated(const std::vector<double>& at, T x, int index) {
  Addend hat;
  hat.at = at;
  hat.stiffness = VectorXd::Unit(static_cast<Eigen::Index>(at.size()), index);
  std::vector<T> breaks = {T(0.0), x};
  for (double p : at)
    if ((p > 0.0 && p < x) || (p < 0.0 && p > x)) breaks.push_back(T(p));
  std::sort(breaks.begin(), breaks.end(),
            [&](const T& a, const T& b) { return x > 0.0 ? a < b : a > b; });
  T sum(0.0);
  for (size_t i = 0; i + 1 < breaks.size(); ++i)
    sum += 0.5 * (breaks[i + 1] - breaks[i]) *
           (curvature(hat, breaks[i]) + curvature(hat, breaks[i + 1]));
  return sum;
}

template <class T>
T energy_anew(const AdditiveModel& model, const Eigen::Matrix<T, 3, 3>& F0) {
  using std::pow;
  using std::sqrt;
  const Eigen::Matrix<T, 3, 3> F = F0 * model.frame.cast<T>();
  const Eigen::Matrix<T, 3, 3> C = F.transpose() * F;
  const T J = F.row(0).dot(F.row(1).cross(F.row(2)));
  const auto component = [&](int c) -> T {
    using K = StrainComponent::Kind;
    const auto E = [&](int i, int j) -> T { return 0.5 * (C(i, j) - (i == j ? 1.0 : 0.0)); };
    switch (model.components[c].kind) {
      case K::e11:
        return E(0, 0);
      case K::e22:
        return E(1, 1);
      case K::e33:
        return E(2, 2);
      case K::e12:
        return E(0, 1);
      case K::e13:
        return E(0, 2);
      case K::e23:
        return E(1, 2);
      case K::trace:
        return E(0, 0) + E(1, 1) + E(2, 2);
      case K::i1bar:
        return sqrt(pow(J, -2.0 / 3) * C.trace() - 3.0);
      case K::volume:
        return J - 1.0;
      case K::fibre:
        return sqrt((F0 * model.components[c].direction.cast<T>()).squaredNorm()) - 1.0;
    }
    return T(0.0);
  };
  T sum(0.0);
  for (const Addend& a : model.addends) {
    T x = component(a.first);
    if (a.even && x < 0.0) x = -x;
    if (a.second < 0) {
      sum += twice_integrated(a.at, x, [&](const T& s) { return curvature(a, s); });
      continue;
    }
    const T y = component(a.second);
    for (size_t i = 0; i < a.at.size(); ++i)
      for (size_t j = 0; j < a.at_second.size(); ++j)
        sum += a.stiffness[static_cast<Eigen::Index>(i * a.at_second.size() + j)] *
               once_integrated(a.at, x, static_cast<int>(i)) *
               once_integrated(a.at_second, y, static_cast<int>(j));
  }
  using std::log;
  if (model.barrier_modulus > 0 && J < model.barrier_below) {
    const T d = J - model.barrier_below;
    sum -= model.barrier_modulus * d * d * log(J / model.barrier_below);
  }
  return sum;
}

}  // namespace hookeye::test
