// Evidence of a linear hypothesis on a residual: Gaussian marginal likelihood with the effective
// number of residuals, one maximum-likelihood prior variance, and noise at least the floor
// (method.md, "Which effect is missing", 3; MacKay 1992).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace hookeye {

/// Sums over the effective residuals, in units of noise.
struct EffectiveSums {
  Eigen::MatrixXd H;    ///< J^T J over all columns, weighted
  Eigen::VectorXd s;    ///< J^T r, weighted
  double r2 = 0.0;      ///< |r|^2, weighted
  double count = 0.0;   ///< N_eff
  double floor2 = 1.0;  ///< least noise variance
};

/// A hypothesis: columns of the sums, projected against the first `base` columns.
struct Hypothesis {
  int first = 0, count = 0;
  Eigen::VectorXd typical;  ///< prior scale of each parameter
  bool one_sided = false;   ///< one parameter that may only grow from its null
  /// Bounds of a single parameter, from its null.
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  /// Parameters that may only grow from their nulls; empty: none of several (one: one_sided).
  std::vector<bool> grows = {};
  std::vector<bool> held = {};  ///< parameters that stay at their nulls; empty: none
};

/// Quadratic form left after the base columns: M = H_cc - H_ca H_aa^+ H_ac, eigen-decomposed in
/// units of `typical`. Modes that the base columns can make (to rounding) are left out of all of
/// it.
struct ProjectedHypothesis {
  Eigen::MatrixXd M;        ///< count x count, parameter units
  Eigen::MatrixXd to_base;  ///< H_aa^+ H_ac: base x count
  Eigen::MatrixXd modes;    ///< columns: eigenvectors of D M D; zero: left out
  Eigen::VectorXd eigenvalues;
  Eigen::VectorXd typical;
  int first = 0, base = 0;
  bool one_sided = false;
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  /// Largest squared signal over noise that a change of typical size makes: below 4 (two standard
  /// deviations) these photos cannot test an effect of that size.
  double best_signal() const;
  Eigen::VectorXd projected_score(const Eigen::VectorXd& s) const;  ///< s~
  Eigen::MatrixXd inverse() const;                                  ///< M^+
  /// Step t = -M^+ s~ (directions without signal stay at the null), of a single parameter within
  /// its bounds.
  Eigen::VectorXd step(const Eigen::VectorXd& s) const;
  /// The same with every parameter in [low, high] (from its null): those that the step takes out of
  /// it stay at the bound, the farthest first, and the others step given that. Clamped alone, one
  /// of two parameters that nearly undo each other would leave the other's large step behind.
  Eigen::VectorXd step_within(const Eigen::VectorXd& s, const Eigen::VectorXd& low,
                              const Eigen::VectorXd& high) const;
  double fall(const Eigen::VectorXd& s) const;  ///< s~^T M^+ s~, or less within bounds
};
ProjectedHypothesis project(const Eigen::MatrixXd& H, int base, const Hypothesis& hypothesis);

/// The hypothesis with those of its growing parameters held that the step to its best fit would
/// take below their nulls: non-negative least squares, one parameter out at a time.
Hypothesis within_bounds(const Eigen::MatrixXd& H, int base, const Hypothesis& hypothesis,
                         const Eigen::VectorXd& s);

/// log p(r | effect) - log p(r | no effect) for the score s and |r|^2 = r2 (base part removed; or
/// more, such that the effect leaves the noise: what it removes may be more than cells show).
/// `mean`: the parameters' mean under the prior that it chose.
double log_evidence(const ProjectedHypothesis& hypothesis, const Eigen::VectorXd& s, double r2,
                    double count, double floor2, Eigen::VectorXd* mean = nullptr);
/// The same where the noise is told (sensors): `noise2`, or what the effect itself leaves of few
/// values, if that is more, in both likelihoods. One value 100 deviations off speaks for whatever
/// removes it, and an effect that removes half of a misfit does not feed on the other half.
double log_evidence_of_told_noise(const ProjectedHypothesis& hypothesis, const Eigen::VectorXd& s,
                                  double r2, double count, double noise2);
/// Gain of the best fit in log-likelihood, noise at least the floor, less 1/2 dof log N (Schwarz
/// 1978).
double bayes_information(const ProjectedHypothesis& hypothesis, const Eigen::VectorXd& s, double r2,
                         double count, double floor2);

/// log of the mean of exp: evidence of an effect with several forms.
double log_mean_exp(const Eigen::VectorXd& values);

}  // namespace hookeye
