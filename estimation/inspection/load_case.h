// One load case: how the body moved in its photos, and how the first guess says that it would.
#pragma once

#include <vector>

#include "estimation/inspection/motion.h"

namespace hookeye::inspection {

struct LoadCase {
  int example = 0;
  std::vector<Motion> motions;  ///< of its photos by cameras that are right, where enough is found
  MotionSums first_order;       ///< against the first guess to first order
  MotionSums guessed;           ///< against the equilibrium; count 0: there is none
};

/// Motions are against each camera's reference photo. Empty `motions`: nothing can be told.
LoadCase load_case(Sight& sight, int e);

/// The mean motion of each photo, which a camera that was moved has, too.
enum class Shift { kept, removed };
/// Seen against what another answer (displacement to first order, 3 x nv) would look like.
MotionSums against(Sight& sight, const LoadCase& seen, const Matrix3Xd& answer,
                   Shift shift = Shift::kept);

/// Without the mean of each, over the points that both have.
void remove_mean(std::vector<Vector2d>& seen, std::vector<Vector2d>& expected);

/// Nothing but forces moves the body: how far, the moduli decide.
bool moved_by_forces(const ExampleSpec& example);
/// A support moves by an amount that a fit has to find.
bool moved_by_unknown(const ExampleSpec& example);

}  // namespace hookeye::inspection
