// The reduced fit: Ceres moves the parameters, pixels never reach it (method.md, Fit).
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/decision.h"

namespace hookeye {

struct FitProgress {
  std::string stage;  ///< "1/8 size", "motion", "'pull' alone", "full size", "final"
  int iteration = 0, of = 0;
  double chi = 0.0;
};

/// From the equilibria of the model that a rival is held against, twice what a step may take: one
/// without an equilibrium in a held-out example was sought for minutes.
constexpr int kRivalIterations = 2 * kStepIterations;

struct FitOptions {
  std::optional<int> max_iterations;  ///< empty: FitLimits
  bool coarse_to_fine = true;
  /// Huber's threshold in multiples of the photos' own misfit (median absolute residual over that
  /// of unit noise, at least 1): outliers of a misfit model are judged against its misfit. Empty:
  /// FitLimits.
  std::optional<double> huber;
  /// chi of the fitted photos that a rival has come to already: a fit that falls so slowly that it
  /// would not get there in twenty steps more ends. 0: there is none.
  double aim_chi = 0.0;
  /// Newton iterations of an example's equilibrium where the fit has ended, held-out ones' too
  /// (EquilibriumOptions::most_iterations). Of a rival that may be given up: kRivalIterations.
  int most_iterations = EquilibriumOptions{}.most_iterations;
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(const FitProgress&)> progress;
  Decided decided;  ///< of a search

  int iterations(const Scene& scene) const {
    return max_iterations.value_or(scene.limits->fit.max_iterations);
  }
  double huber_times(const Scene& scene) const { return huber.value_or(scene.limits->fit.huber); }
};

/// One step of the progressive estimation of an additive material (progressive.h).
struct RefinementStage {
  std::string what;                       ///< "start", "control point E11 = 0.21", "addend E22"
  double evidence = 0.0;                  ///< log evidence before the refit
  int values = 0;                         ///< control values
  double misfit_fit = 0.0;                ///< sum of squares over noise after the refit
  std::optional<double> misfit_held_out;  ///< empty: nothing is held out
  /// Least over the accepted steps [stress].
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  bool kept = false;
};

/// What all pixels say of a model that was fitted to photos read in part (over_all_pixels.h).
struct AllPixels {
  VectorXd value;       ///< where they would have the parameters, to first order
  VectorXd error;       ///< standard errors by all pixels, as intervals have them
  VectorXd read_error;  ///< the same by the pixels that are read
  VectorXd added;       ///< what noise adds to the standard error where only those are
  double share = 1.0;   ///< of the pixels of the size that is read, those that the fit has seen
  double pixels = 0.0, read_pixels = 0.0;  ///< as taken, and as read, that count in fitted examples
  double chi_fit = 0.0, chi_validate = 0.0;  ///< of the pixels as they were taken
};

/// A fitted model with its pictures and normal equations at full size.
struct Fitted {
  ModelForm form;
  VectorXd p;
  /// 95 % intervals, not fooled by correlated residuals; of the mesh they know once
  /// reach_for_mesh() has been there.
  VectorXd low, high;
  std::optional<AllPixels> all_pixels;  ///< low and high are then about its values
  /// What the intervals have more on one side because of the mesh; empty: nothing.
  VectorXd mesh_reach;
  std::vector<std::string> undetermined;  ///< sentences: what these data cannot fix
  Evaluation evaluation;                  ///< fitted and held-out, pictures and derivatives
  int iterations = 0;
  bool converged = false;
  std::vector<RefinementStage> refinements;  ///< additive material only
  /// The same, its last stage: least over the accepted steps. Not a number: another material.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

/// The fitted model with its equilibria.
Model realised(const Fitted& fitted);

/// Least squares over photos, forces, moments and positions of the fitted examples, from `start`.
/// Where that ends pictures apart by more than their patterns span, or the start has no
/// equilibrium, moduli that were told wrong by up to two orders of magnitude are looked for and it
/// starts there. Throws std::logic_error for a wrong size of start.
Result<Fitted> fit(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                   const FitOptions& options = {});

/// p with the numbers that concern held-out examples alone (Parameter::example) fitted to those,
/// all others as they are. fit() ends with it.
Result<VectorXd> settle_held_out(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                                 const FitOptions& options = {});

/// The starting point again without moving anything: pictures, intervals, what is undetermined.
Result<Fitted> assess(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                      const FitOptions& options = {});

/// Standard errors; 0: nothing in the data holds the parameter.
VectorXd errors_of(const ParameterCovariance& covariance);
/// The fitted model's low and high from those, about its own values or those of all pixels. And
/// what mesh_reach widens them by.
void tell_intervals(const VectorXd& error, const VectorXd& about, Fitted* fitted);
void widen_by_mesh(Fitted& fitted);

/// Misfit that Huber's threshold is measured in: 1.48 median |r| of the fitted photos' pictures.
double misfit_scale(const Evaluation& evaluation);

/// A look without derivatives at 1 / 2^level of the size.
EvaluationOptions only_pictures(int level, const FitOptions& options);

}  // namespace hookeye
