// Progressive estimation of the additive model (Miguel, Miraut, Otaduy 2016, section 5): local
// optimization, projection to convexity, equilibrium of all examples; a control point or an addend
// more where the residual asks for it; stopped by the held-out error.
#pragma once

#include <functional>

#include "estimation/fit.h"
#include "simulation/additive.h"

namespace hookeye {

struct ProgressiveOptions {
  FitOptions fit;
  int most_refinements = 24;
  /// Refinements in a row that are followed although held-out examples agree worse.
  int patience = 2;
};

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
std::variant<ConvexFit, NumericalFailure> fit_convex(Workspace& workspace, const ModelForm& form,
                                                     const VectorXd& start,
                                                     const FitOptions& options = {});

/// The same until it settles, far pictures made linear in the motion first, and assessed: what
/// fit() does with a form that has an additive material.
std::variant<Fitted, NumericalFailure> fit_convex_to_end(Workspace& workspace,
                                                         const ModelForm& form,
                                                         const VectorXd& start,
                                                         const FitOptions& options = {});

/// One more function that the material may need: a hat at a new control point of an addend, or a
/// new addend. Zero at its null.
struct Refinement {
  std::string what;                             ///< "control point E11 = 0.21", "addend E22"
  std::function<void(AdditiveModel&)> add;      ///< puts it in; the energy stays the same
  std::shared_ptr<const Ingredient> candidate;  ///< the function alone, to be scored
};
/// What the strains of the fitted examples would let the data see: the middles of the intervals
/// between the control points within the visited range, its ends, components without an addend, and
/// pairs of components that have one.
std::vector<Refinement> refinements(const ModelForm& form, const Fitted& fitted);

/// From a form with an additive material (to_additive): refinements one after the other, scored
/// without refitting, the leading ones fitted; what is returned agrees best with the held-out
/// examples, and `Fitted::refinements` tells which led there. Without held-out examples the
/// log evidence alone decides (kTie).
std::variant<Fitted, NumericalFailure> fit_progressive(Workspace& workspace, const ModelForm& form,
                                                       const VectorXd& start,
                                                       const ProgressiveOptions& options = {});

}  // namespace hookeye
