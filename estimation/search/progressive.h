// Progressive estimation of the additive model (Miguel, Miraut, Otaduy 2016, section 5): a convex
// fit, a control point or an addend more where the residual asks for it; stopped by the held-out
// error.
#pragma once

#include <functional>

#include "estimation/fit/fit.h"
#include "simulation/additive.h"

namespace hookeye {

struct ProgressiveOptions {
  FitOptions fit;
  int most_refinements = 24;
  /// Refinements in a row that are followed although held-out examples agree worse.
  int patience = 2;
};

/// One more function that the material may need: a hat at a new control point of an addend, or a
/// new addend. Zero at its null.
struct Refinement {
  std::string what;     ///< "control point E11 = 0.21", "addend E22"
  size_t material = 0;  ///< of the form's additive ones
  /// A control point of a coupling: a whole row of values, tried once nothing simpler is asked for.
  bool grid = false;
  std::function<void(AdditiveModel&)> add;      ///< puts it in; the energy stays the same
  std::shared_ptr<const Ingredient> candidate;  ///< the function alone, to be scored
};
/// What the strains of the fitted examples would let the data see: the middles of the intervals
/// between the control points within the visited range, its ends, components without an addend, and
/// pairs of components that have one.
std::vector<Refinement> refinements(const ModelForm& form, const Fitted& fitted);

/// A form with an additive material and its values (to_additive).
using AdditiveStart = std::pair<ModelForm, VectorXd>;
/// From the start that fits best (a textbook law may have run to values from which the additive
/// energy does not find back; the capture's own are the other start): refinements one after the
/// other, scored without refitting, the leading ones fitted; what is returned agrees best with the
/// held-out examples, and `Fitted::refinements` tells which led there. Without held-out examples
/// the log evidence alone decides (DiagnosisLimits::tie).
Result<Fitted> fit_progressive(Workspace& workspace, const std::vector<AdditiveStart>& starts,
                               const ProgressiveOptions& options = {});

}  // namespace hookeye
