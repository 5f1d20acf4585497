// Evidence of a whole model by the chain rule: log p(fitted data) + log p(held-out data | fitted
// data), each with the parameters integrated over (method.md, "One score, in the shadow"; MacKay
// 1992). The model is linear about its fitted values, noise and prior are normal: all is m x m.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/fit/evidence.h"

namespace hookeye {

/// Normal prior of the parameters, told from their fitted values.
struct GaussianPrior {
  Eigen::VectorXd mean;       ///< less the fitted values
  Eigen::MatrixXd precision;  ///< positive in every direction that some data see
  /// Of a parameter that may only grow from its null (half a normal density, twice as high): how
  /// far the fitted value is above it. Infinite: it may go both ways.
  Eigen::VectorXd above;
};

/// log of the integral of p(data | parameters) p(parameters), but for N/2 log 2 pi. A group of
/// residuals has sums of its own, in units of its least noise, and a variance in those units: its
/// covariance is what the sums were weighed by times that, and with the prior's part J P^-1 J^T.
double log_marginal(const std::vector<EffectiveSums>& groups, const Eigen::VectorXd& variances,
                    const GaussianPrior& prior);

/// Of every group the variance, floor2 of its sums at least, with which log_marginal is largest.
/// The first ones may be told already.
Eigen::VectorXd suiting_variances(const std::vector<EffectiveSums>& groups,
                                  const GaussianPrior& prior, const Eigen::VectorXd& told = {});

struct ChainEvidence {
  double fitted = 0.0;    ///< log p(fitted)
  double held_out = 0.0;  ///< log p(held out | fitted): noise and J V J^T, V of the fitted values
};
ChainEvidence chain_evidence(const std::vector<EffectiveSums>& fitted,
                             const std::vector<EffectiveSums>& held_out,
                             const GaussianPrior& prior);

}  // namespace hookeye
