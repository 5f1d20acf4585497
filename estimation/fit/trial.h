// One step of a fit, to see how far it gets: what a race is run in.
#pragma once

#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/fit.h"

namespace hookeye {

/// p after the step dx in units of `scaling`, within bounds; no parameter moves by more than a
/// factor e or by its typical size times ten.
VectorXd bounded_step(const Scaling& scaling, const VectorXd& p, const VectorXd& dx);

/// What one Gauss-Newton step on the motion in half-size pictures makes of a model.
struct Trial {
  VectorXd p;
  /// Root mean square of residual over noise, made linear in the motion, half-size pictures.
  double chi_fit = 0.0, chi_validate = 0.0;
  double floor = 0.0;  ///< the same of the rest photos (floor.h); 0: not known
};
/// What the trials of a race are measured against: the model that they start from.
struct TrialScale {
  double huber = 0.0;                    ///< Huber's threshold in units of noise
  double chi = 0.0, chi_validate = 0.0;  ///< Trial's, of that model
  double floor = 0.0;                    ///< Trial::floor
  double measured_weight = 1.0;          ///< Evaluation::measured_weight
};
Result<TrialScale> trial_scale(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                               const FitOptions& options = {});
/// The whole step, or the part of it that lowers the misfit. Fails where the start has no
/// equilibrium or is worse than the model of `scale`.
Result<Trial> try_step(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                       const TrialScale& scale, const FitOptions& options = {});

/// Where steps from `start` lead in half-size pictures, at a small part of a fit's cost.
struct Followed {
  Trial trial;
  /// The last step took less than a twentieth of what was over the floor: it ends about there.
  bool stalled = false;
};
inline constexpr int kMostTrials = 6;  ///< steps from one start
/// At most `steps` of them. Fails where the start has no equilibrium.
Result<Followed> follow(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                        const TrialScale& scale, const FitOptions& options = {},
                        int steps = kMostTrials);

/// What is over the floor of the fitted and of the held-out photos, as chi^2, both together.
double over_floor(const Trial& trial);

}  // namespace hookeye
