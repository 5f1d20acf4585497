// The sums that a diagnosis weighs its evidence by (method.md, "Honest tests").
#pragma once

#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/evidence.h"
#include "estimation/fit/floor.h"

namespace hookeye {

/// Sums over cells rather than pixels, every photo weighted by its effective share, and the
/// covariance of the score under noise correlated as the residual is.
struct DiagnosisSums {
  EffectiveSums effective;
  /// For what changes sensors alone: the residuals are those of forces, moments and positions, in
  /// their told noise; photos, in the noise that their misfit shows, only hold the model in place.
  EffectiveSums measured;
  double measured_count = 0.0;  ///< sensors' values of fitted examples
  Eigen::MatrixXd noise;        ///< covariance of effective.s, correlated as this residual is
  Eigen::MatrixXd null_noise;   ///< the same when only the floor is left
  NormalEquations fitted;       ///< plain sums over pixels and measured values
  /// Plain sums over pixels alone: what an effect explains is said of photos. Where no example has
  /// one, over fields; where none has one, over sensors' values.
  NormalEquations seen, seen_held_out;
  double pixel_floor2 = 1.0;
  double photo_r2 = 0.0, photo_count = 0.0, held_r2 = 0.0, held_count = 0.0;
  double whiteness_p = 1.0;
};

DiagnosisSums diagnosis_sums(const Evaluation& evaluation, const Floor& floor);

/// Sum of squares of fitted forces, moments and positions over told noise; after a step of all
/// columns, where there is one.
double measured_r2(const Evaluation& evaluation, const VectorXd* step = nullptr);

/// |r|^2 less what the first `base` columns alone would still gain.
double without_base(const EffectiveSums& sums, int base, const DiagnosisLimits& limits);

}  // namespace hookeye
