// How the points of a measured field moved, and how the first guess says that they would.
#pragma once

#include <vector>

#include "estimation/inspection/inspection.h"
#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Of every field of example `e`, to first order. Empty: it has none, or there is no first guess.
std::vector<FieldMotion> field_motions(Sight& sight, int e);

}  // namespace hookeye::inspection
