// How much a refitted model says, for its number of parameters.
#pragma once

#include "estimation/fit/fit.h"
#include "estimation/fit/floor.h"

namespace hookeye {

/// What refits are scored by, the same for all that are compared.
struct Yardstick {
  const Fitted* reference;  ///< whose residuals' correlation counts
  const Floor* floor;
  /// Variance of forces, moments and positions in units of what was told of them: the least that
  /// any of the compared leaves. A renderer's errors in the photos are none of it.
  double measured_noise2;
};

/// chi of fitted and of held-out photos together.
double misfit(const Fitted& fitted);

/// Mean square of what `fitted` leaves of forces, moments and positions, 1 (as told) at least.
double measured_noise2(const Fitted& fitted);

/// log-likelihood of a fitted model with the effective number of residuals: fitted and held-out
/// photos, each with a variance of their own, and measurements; minus (dof/2) log N (BIC). (While
/// something large is missing, held-out photos may miss by three times as much: of one variance for
/// all they alone would choose, by how a wrong model happens to extrapolate.) N is of the values
/// that show a parameter: for an error of the sensors, which no photo shows, the measured ones
/// alone.
double refit_score(const Fitted& fitted, const Yardstick& yardstick);

/// Whether the held-out examples speak against `with`: by their log-likelihood, less than a tie
/// (DiagnosisLimits::tie) is no word. Nor is a rise of the photos' chi^2 by no more than `least`,
/// which meshes and renderers err by (least_fall): once all else is white, likelihood tells
/// hundredths of a pixel, and an effect that took away nine tenths of the fitted misfit was refused
/// for them. Beyond that they speak against what makes all photos together, fitted and held out,
/// miss by more: the likelihood of a few cells may not see it (one photo near the floor is a dozen
/// of independent ones), and what adds a parameter and no misfit less says nothing at all. An
/// effect that no held-out example can show, like a contact in one load case, is judged by the
/// fitted ones.
bool held_out_allows(const Fitted& with, const Fitted& without, const Floor& floor,
                     double least = 0.0);

}  // namespace hookeye
