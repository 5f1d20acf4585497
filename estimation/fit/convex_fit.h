// One stage of the estimation of the additive model (Miguel, Miraut, Otaduy 2016, section 5): local
// optimization, projection to convexity, equilibrium of all examples.
#pragma once

#include "estimation/fit/fit.h"

namespace hookeye {

/// Gauss-Newton steps with Marquardt's damping from `start`, at full size. Every step is the
/// minimum of the damped quadratic model over convex control values (project_convex in the metric
/// of that model); it is accepted only with an equilibrium of all fitted examples and a lower
/// misfit. So the smallest eigenvalue after every accepted step is not negative: `eigenvalues`, the
/// start first.
struct ConvexFit {
  VectorXd p;
  std::vector<double> eigenvalues;
  int iterations = 0;
  bool converged = false;
  bool registered = false;  ///< pictures were compared by their motion
};
Result<ConvexFit> fit_convex(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                             const FitOptions& options = {});

/// The same until it settles, far pictures made linear in the motion first, and assessed: what
/// fit() does with a form that has an additive material.
Result<Fitted> fit_convex_to_end(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                                 const FitOptions& options = {});

}  // namespace hookeye
