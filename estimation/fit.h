// The reduced fit: Ceres moves the parameters, pixels never reach it (method.md, Fit).
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "estimation/evaluation.h"

namespace hookeye {

struct FitProgress {
  std::string stage;  ///< "1/8 size", "motion", "full size", "final"
  int iteration = 0, of = 0;
  double chi = 0.0;
};

struct FitOptions {
  int max_iterations = 20;
  bool coarse_to_fine = true;
  /// Huber's threshold in multiples of the photos' own misfit (median absolute residual over that
  /// of unit noise, at least 1): outliers of a misfit model are judged against its misfit.
  double huber = 4.0;
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(const FitProgress&)> progress;
};

/// A fitted model with its pictures and normal equations at full size.
struct Fitted {
  ModelForm form;
  VectorXd p;
  VectorXd low, high;                     ///< 95 % intervals, not fooled by correlated residuals
  std::vector<std::string> undetermined;  ///< sentences: what these data cannot fix
  Evaluation evaluation;                  ///< fitted and held-out, pictures and derivatives
  int iterations = 0;
  bool converged = false;
};

/// Least squares over photos, forces, moments and positions of the fitted examples, from `start`.
/// Throws std::logic_error for a wrong size of start. The start must have an equilibrium.
std::variant<Fitted, NumericalFailure> fit(Workspace& workspace, const ModelForm& form,
                                           const VectorXd& start, const FitOptions& options = {});

/// What one Gauss-Newton step on the motion in half-size pictures makes of a model.
struct Trial {
  VectorXd p;
  /// Root mean square of residual over noise, made linear in the motion, half-size pictures.
  double chi_fit = 0.0, chi_validate = 0.0;
};
/// What the trials of a race are measured against: the model that they start from.
struct TrialScale {
  double huber = 0.0;  ///< Huber's threshold in units of noise
  double chi = 0.0;    ///< Trial::chi_fit of that model
};
std::variant<TrialScale, NumericalFailure> trial_scale(Workspace& workspace, const ModelForm& form,
                                                       const VectorXd& p,
                                                       const FitOptions& options = {});
/// The whole step, or the part of it that lowers the misfit. Fails where the start has no
/// equilibrium or is worse than the model of `scale`.
std::variant<Trial, NumericalFailure> try_step(Workspace& workspace, const ModelForm& form,
                                               const VectorXd& start, const TrialScale& scale,
                                               const FitOptions& options = {});

/// The starting point again without moving anything: pictures, intervals, what is undetermined.
std::variant<Fitted, NumericalFailure> assess(Workspace& workspace, const ModelForm& form,
                                              const VectorXd& p, const FitOptions& options = {});

/// Sums of the fitted examples' photos and measurements.
struct NormalEquations {
  Eigen::MatrixXd JtJ;
  VectorXd Jtr;
  double r2 = 0.0;
};
NormalEquations normal_equations(const Evaluation& evaluation, bool held_out = false);

/// Covariance H^-1 (sum_k lambda_k H_k) H^-1 of the first `size` parameters: lambda_k is how much
/// the variance of a smooth signature in photo k exceeds that under white noise (flow.h).
/// Directions without information are left out (pseudo-inverse).
Eigen::MatrixXd parameter_covariance(const Evaluation& evaluation,
                                     const std::vector<Parameter>& parameters, const VectorXd& p,
                                     std::vector<std::string>* undetermined);

}  // namespace hookeye
