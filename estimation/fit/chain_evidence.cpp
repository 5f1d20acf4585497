#include "estimation/fit/chain_evidence.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace hookeye {

namespace {

/// Of a prior's precision, in units of all that is known of a parameter: a direction that neither
/// data nor prior tell of has the same density before and after.
constexpr double kUntold = 1e-12;

/// log |M| of a Cholesky factor's M.
double log_determinant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2.0 * Eigen::MatrixXd(factor.matrixLLT()).diagonal().array().log().sum();
}

/// Sums of all groups, each over its variance.
EffectiveSums together(const std::vector<EffectiveSums>& groups, const Eigen::VectorXd& variances,
                       Eigen::Index columns) {
  EffectiveSums out;
  out.H.setZero(columns, columns);
  out.s.setZero(columns);
  for (size_t g = 0; g < groups.size(); ++g) {
    const double variance = variances[static_cast<Eigen::Index>(g)];
    out.H += groups[g].H / variance;
    out.s += groups[g].s / variance;
    out.r2 += groups[g].r2 / variance;
  }
  return out;
}

/// The place of the maximum of `f` between low and high, by golden section.
template <class Function>
double largest_between(double low, double high, const Function& f) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double fa = f(a), fb = f(b);
  while (high - low > 1e-4) {
    if (fa > fb) {
      high = b, b = a, fb = fa;
      a = high - kGolden * (high - low), fa = f(a);
    } else {
      low = a, a = b, fa = fb;
      b = low + kGolden * (high - low), fb = f(b);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

double log_marginal(const std::vector<EffectiveSums>& groups, const Eigen::VectorXd& variances,
                    const GaussianPrior& prior) {
  double log_noise = 0.0;
  for (size_t g = 0; g < groups.size(); ++g)
    log_noise += groups[g].count * std::log(variances[static_cast<Eigen::Index>(g)]);
  const Eigen::Index m = prior.mean.size();
  const EffectiveSums all = together(groups, variances, m);
  if (m == 0) return -0.5 * (log_noise + all.r2);
  const Eigen::VectorXd unit =
      (all.H.diagonal() + prior.precision.diagonal()).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd before = unit.asDiagonal() * prior.precision * unit.asDiagonal();
  before.diagonal().array() += kUntold;
  const Eigen::MatrixXd after = before + unit.asDiagonal() * all.H * unit.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> prior_factor(before), factor(after);
  const Eigen::VectorXd slope = unit.cwiseProduct(all.s - prior.precision * prior.mean);
  const Eigen::VectorXd step = -factor.solve(slope);
  const double left =
      std::max(0.0, all.r2 + prior.mean.dot(prior.precision * prior.mean) + slope.dot(step));
  double out =
      -0.5 * (log_noise + left) + 0.5 * (log_determinant(prior_factor) - log_determinant(factor));
  for (Eigen::Index i = 0; i < m; ++i)
    if (std::isfinite(prior.above[i])) {  // what the posterior has of the other side is not there
      const double variance = factor.solve(Eigen::VectorXd::Unit(m, i))[i];
      const double deviations =
          (prior.above[i] / unit[i] + step[i]) / std::sqrt(std::max(variance, 1e-300));
      out += std::log(std::max(std::erfc(-deviations / std::sqrt(2.0)), 1e-300));
    }
  return out;
}

Eigen::VectorXd suiting_variances(const std::vector<EffectiveSums>& groups,
                                  const GaussianPrior& prior, const Eigen::VectorXd& told) {
  Eigen::VectorXd out(groups.size());
  for (Eigen::Index g = 0; g < out.size(); ++g) {
    const EffectiveSums& group = groups[static_cast<size_t>(g)];
    out[g] = g < told.size() ? told[g]
                             : std::max(group.floor2, group.r2 / std::max(group.count, 1e-300));
  }
  // Groups know of one another by the parameters alone: the second round moves little.
  for (int round = 0; round < 2; ++round)
    for (Eigen::Index g = told.size(); g < out.size(); ++g) {
      const EffectiveSums& group = groups[static_cast<size_t>(g)];
      if (group.count <= 0.0 || group.r2 / group.count <= group.floor2) continue;
      const auto with = [&](double log_variance) {
        out[g] = std::exp(log_variance);
        return log_marginal(groups, out, prior);
      };
      const double best =
          largest_between(std::log(group.floor2), std::log(group.r2 / group.count), with);
      out[g] = std::exp(best);
    }
  return out;
}

ChainEvidence chain_evidence(const std::vector<EffectiveSums>& fitted,
                             const std::vector<EffectiveSums>& held_out,
                             const GaussianPrior& prior) {
  const Eigen::VectorXd of_fitted = suiting_variances(fitted, prior);
  std::vector<EffectiveSums> all = fitted;
  all.insert(all.end(), held_out.begin(), held_out.end());
  ChainEvidence out;
  out.fitted = log_marginal(fitted, of_fitted, prior);
  out.held_out = log_marginal(all, suiting_variances(all, prior, of_fitted), prior) - out.fitted;
  return out;
}

}  // namespace hookeye
