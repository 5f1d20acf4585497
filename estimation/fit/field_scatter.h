// The least noise that a measured field can have: how its points scatter about what is smooth.
#pragma once

#include <optional>
#include <vector>

#include "estimation/model/model.h"

namespace hookeye {

/// Standard deviations of noise by component, in the unit of what the field holds.
struct LeastNoise {
  std::vector<double> sigma;
  double error = 0.0;  ///< standard error of each, relative
};

/// A lower bound of the noise of a field, loaded or not, by the scatter of neighbouring points.
///
/// Of points spread over the surface the nearest 13 (on a square grid all within two steps) are
/// fitted by a surface of second order in their tangent plane. What it leaves, per degree of
/// freedom and in the middle over the points, is V1; of the nearest 49 (within four steps) V2.
/// White noise leaves the same in both. A bend of the field, or an edge of the body below it,
/// leaves what grows with the square of the size, and what is smooth more: 49/13 times V1 or more.
/// So
///   sigma^2 >= (49/13 V1 - V2) / (49/13 - 1)
/// Noise that neighbours share does not show, and what a filter has smoothed shows in part.
/// Empty: too few points, too crooked a surface below them, or strains, which jump where a
/// material, a window or a mesh ends.
std::optional<LeastNoise> scatter_of_neighbours(const MeasuredSpec& field);

/// The same by another field of the same points in the same load case: half of what is rough in the
/// difference. What neighbours share shows, too. Empty: they are not of the same points and axes.
std::optional<LeastNoise> scatter_of_repeats(const MeasuredSpec& one, const MeasuredSpec& other);

/// By what a plane in each small piece leaves of one, for fields at rest (rough_field()). Empty:
/// too few points.
std::optional<LeastNoise> scatter_in_pieces(const MeasuredSpec& field);

}  // namespace hookeye
