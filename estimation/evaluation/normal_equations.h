// Gauss-Newton's normal equations: their sums, their units, the covariance that follows from them.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "estimation/evaluation/evaluation.h"

namespace hookeye {

/// What a fit moves: x = log p for positive parameters, p / typical for the others.
struct Scaling {
  std::vector<Parameter> parameters;
  /// Within the bounds, which exp(log(bound)) may miss by its rounding.
  VectorXd to_p(const VectorXd& x) const {
    VectorXd p(x.size());
    for (int i = 0; i < x.size(); ++i)
      p[i] = std::clamp(parameters[i].positive ? std::exp(x[i]) : x[i] * parameters[i].typical,
                        parameters[i].low, parameters[i].high);
    return p;
  }
  VectorXd to_x(const VectorXd& p) const {
    VectorXd x(p.size());
    for (int i = 0; i < p.size(); ++i) x[i] = to_x(i, p[i]);
    return x;
  }
  double to_x(int i, double value) const {
    return parameters[i].positive ? std::log(std::max(value, 1e-300))
                                  : value / parameters[i].typical;
  }
  VectorXd dp_dx(const VectorXd& p) const {
    VectorXd d(p.size());
    for (int i = 0; i < p.size(); ++i) d[i] = parameters[i].positive ? p[i] : parameters[i].typical;
    return d;
  }
};

/// Sums of the fitted examples' photos and measurements.
struct NormalEquations {
  Eigen::MatrixXd JtJ;
  VectorXd Jtr;
  double r2 = 0.0;
};
NormalEquations normal_equations(const Evaluation& evaluation, bool held_out = false);

/// For every parameter, whether it concerns a held-out example alone: nothing but that fixes it.
std::vector<bool> of_held_out(const Capture& capture, const std::vector<Parameter>& parameters);
/// The rows and columns of H where `keep` is set; zero elsewhere.
Eigen::MatrixXd part_of(const Eigen::MatrixXd& H, const std::vector<bool>& keep);

/// The sums of those parameters that the Gauss-Newton step from p moves, least squares within the
/// bounds on which some of them stand (Lawson and Hanson 1974, ch. 23): those that would leave
/// stay, and the others' step knows it. Taken with all and cut off at the bounds, a step on which
/// many depend (what a finer mesh changes) leads elsewhere.
NormalEquations within_bounds(const NormalEquations& sums, const Scaling& scaling,
                              const VectorXd& p);

/// (z, rho) with Jacobian (R, 0): R^T R = J^T J, R^T z = J^T r, rho^2 = |r|^2 - |z|^2. R from the
/// eigenvectors, so that singular directions cost nothing and stay put.
struct CondensedResidual {
  Eigen::MatrixXd R;
  VectorXd z;
  double rho = 0.0;
};

/// `scale`: dp/dx of the units that z and R are in.
CondensedResidual condense(const NormalEquations& sums, const VectorXd& scale);

/// A positive number in units of stress ("MPa", "N/cm^2"); lengths and factors are positive too.
bool is_modulus(const Parameter& one);

/// Covariance H^-1 (sum_k lambda_k H_k) H^-1: lambda_k is how much the variance of a smooth
/// signature in photo k exceeds that under white noise (flow.h). Numbers of a held-out example
/// alone have what its photos say of them with the model as it is.
struct ParameterCovariance {
  Eigen::MatrixXd determined;           ///< without the directions that have no information
  Eigen::MatrixXd undetermined;         ///< of those: a standard deviation of 30 times what matters
  std::vector<std::string> directions;  ///< those, a sentence each
  std::vector<bool> open;               ///< for every parameter: named by one of those sentences
  Eigen::MatrixXd all() const { return determined + undetermined; }
};
ParameterCovariance parameter_covariance(const Evaluation& evaluation,
                                         const std::vector<Parameter>& parameters,
                                         const VectorXd& p);

}  // namespace hookeye
