// What measured fields keep when the model is right, and what is smooth in them.
#pragma once

#include <cmath>

#include "estimation/fit/floor.h"

namespace hookeye {

/// A field's residuals over their noise, point by point, whatever is kept of them for sums.
VectorXd whole_residual(const MeasuredSpec& spec, const MeasuredEvaluation& field);

/// Polynomials of the place, fitted to a field's residuals component by component. Their degree
/// grows with how many independent numbers there are, to FloorLimits::most_degree.
struct SmoothField {
  double explained = 0.0;  ///< fall of |r|^2
  double numbers = 0.0;    ///< fitted
  VectorXd rest;           ///< r without them
};
SmoothField smooth_field(const FieldSpec& field, const VectorXd& r, const FloorLimits& limits);

/// What is left of a field's residuals, or of what it holds, without a plane in each piece of it:
/// noise, for mechanics and misfit are smoother. Pieces of few numbers are left out.
struct RoughField {
  double r2 = 0.0, count = 0.0;
  double chi() const { return count > 0.0 ? std::sqrt(std::max(r2, 0.0) / count) : 0.0; }
};
RoughField rough_field(const FieldSpec& field, const VectorXd& r);

/// Of an evaluation that sees fields and no photo: what is rough in fields at rest. Without any:
/// the told noise, or what is rough in that loaded field which keeps least, if that is more.
Floor field_floor(const Scene& scene, const Evaluation& evaluation);

}  // namespace hookeye
