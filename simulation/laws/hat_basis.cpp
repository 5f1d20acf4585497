#include "simulation/laws/hat_basis.h"

#include <algorithm>

namespace hookeye::laws {

HatBasis::HatBasis(const std::vector<double>& at)
    : rows_(static_cast<Eigen::Index>(at.size())), breaks_(at) {
  if (!std::binary_search(at.begin(), at.end(), 0.0)) {
    breaks_.push_back(0.0);
    std::sort(breaks_.begin(), breaks_.end());
  }
  const int n = static_cast<int>(breaks_.size());
  zero_ = static_cast<int>(std::lower_bound(breaks_.begin(), breaks_.end(), 0.0) - breaks_.begin());
  M_.setZero(rows_, n);
  C_.setZero(rows_, n + 1);
  for (int k = 0; k < n; ++k) {
    const double x = std::clamp(breaks_[k], at.front(), at.back());
    const auto above =
        static_cast<Eigen::Index>(std::lower_bound(at.begin(), at.end(), x) - at.begin());
    if (at[above] == x) {
      M_(above, k) = 1.0;
    } else {
      const double t = (x - at[above - 1]) / (at[above] - at[above - 1]);
      M_(above - 1, k) = 1.0 - t;
      M_(above, k) = t;
    }
  }
  for (int k = 1; k < n; ++k)
    C_.col(k) = (M_.col(k) - M_.col(k - 1)) / (breaks_[k] - breaks_[k - 1]);
  S_.setZero(rows_, n);
  V_.setZero(rows_, n);
  const auto integrate = [&](int from, int to, int cell) {
    const double d = breaks_[to] - breaks_[from];
    S_.col(to) = S_.col(from) + d * M_.col(from) + 0.5 * d * d * C_.col(cell);
    V_.col(to) = V_.col(from) + d * S_.col(from) + 0.5 * d * d * M_.col(from) +
                 d * d * d / 6.0 * C_.col(cell);
  };
  for (int k = zero_; k + 1 < n; ++k) integrate(k, k + 1, k + 1);
  for (int k = zero_; k > 0; --k) integrate(k, k - 1, k);
}

HatBasis::Spot HatBasis::find(double x) const {
  int k = zero_;
  if (x >= 0) {
    while (k + 1 < static_cast<int>(breaks_.size()) && breaks_[k + 1] <= x) ++k;
    return {k, k + 1, x - breaks_[k]};
  }
  while (k > 0 && breaks_[k - 1] > x) --k;
  return {k, k, x - breaks_[k]};
}

HatBasis::Spot HatBasis::find_below(double x) const {
  const Spot spot = find(x);
  const int k = spot.break_index;
  if (spot.d == 0.0) return {k, k, 0.0};
  if (x < 0 && k > 0 && breaks_[k - 1] == x) return {k - 1, k - 1, 0.0};
  return spot;
}

HatBasis::Sum HatBasis::contract(const Eigen::VectorXd& values) const {
  return {M_.transpose() * values, C_.transpose() * values, S_.transpose() * values,
          V_.transpose() * values};
}

}  // namespace hookeye::laws
