// Motion and brightness that are smooth over a photo: what weight, loads, swelling, cameras and
// light do to it. What a renderer gets wrong is rough.
#pragma once

#include <Eigen/Core>

#include "estimation/images/flow.h"
#include "estimation/model/limits.h"

namespace hookeye {

/// Polynomials of the place in x, y and relative brightness, fitted to the cells of a photo.
struct SmoothPart {
  double explained = 0.0;          ///< fall of |r|^2 over noise
  double by_motion = 0.0;          ///< of that, what brightness alone does not explain
  double numbers = 0.0;            ///< fitted
  double numbers_of_motion = 0.0;  ///< of those, motions that the pixels tell of
  Eigen::VectorXd coefficients;    ///< three of every monomial
};

/// Highest degree for which a polynomial has a term for so many cells, FloorLimits::most_degree at
/// most; -1: too few cells.
int smooth_degree(const FlowField& flow, const FloorLimits& limits);

SmoothPart smooth_part(const FlowField& flow, int degree);

/// The field without its smooth part.
FlowField without_smooth(FlowField flow, const SmoothPart& smooth, int degree);

/// What a cell's pixels tell of motion, in the direction of which they tell most [1/px^2], summed:
/// |r|^2 that one pixel of motion brings. Of a rim that is motion across it.
double motion_information(const FlowField& flow);

}  // namespace hookeye
