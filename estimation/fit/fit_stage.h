// One stage of a fit: a look at the pictures, then Ceres on the condensed residuals of one size.
// Internal to fit.
#pragma once

#include <fmt/format.h>

#include <limits>
#include <string>
#include <vector>

#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/fit.h"

namespace hookeye {

/// Which examples move which parameters.
struct FitScope {
  bool held_out = false;     ///< the held-out examples, not the fitted ones
  std::vector<bool> moving;  ///< by parameter
  int only = -1;             ///< this example alone, -1: all
  void choose(EvaluationOptions& options) const {
    options.fitted = !held_out;
    options.held_out = held_out;
    if (only >= 0) options.only = {only};
  }
  /// A parameter that stands still has no column: condense() leaves such where they are.
  NormalEquations of(const Evaluation& evaluation) const {
    NormalEquations sums = normal_equations(evaluation, held_out);
    sums.JtJ = part_of(sums.JtJ, moving);
    for (Eigen::Index i = 0; i < sums.Jtr.size(); ++i)
      if (!moving[i]) sums.Jtr[i] = 0.0;
    return sums;
  }
};

/// One look at the pictures after another: coarse; full size, made linear in the motion; full size.
struct Stage {
  int level = 0;
  bool registered = false;
  bool always = false;
  std::string name() const {
    if (level > 0) return fmt::format("1/{} size", 1 << level);
    return registered ? "motion" : "full size";
  }
  /// Beyond kLinearPx Gauss-Newton on pixels creeps, and on the motion between the pictures it does
  /// not.
  bool serves(double motion_px) const {
    return always || level > 0 || registered == (motion_px > kLinearPx);
  }
};

/// What a stage has to know of the pictures before it starts.
struct Look {
  double misfit = 1.0;  ///< misfit_scale
  double count = 0.0;   ///< pixels; without any photo, numbers of fields
  double motion_px = 0.0;
  double measured_weight = 1.0;  ///< Evaluation::measured_weight
};

Result<Look> look(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                  const FitOptions& options, const FitScope& scope, int level);

struct StageResult {
  VectorXd p;
  bool converged = false;
  int iterations = 0;
  /// Named values of an additive material: least over the accepted steps [stress]; else no number.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

Result<StageResult> run_stage(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                              const FitOptions& options, const FitScope& scope, Stage stage,
                              const Look& seen);

}  // namespace hookeye
