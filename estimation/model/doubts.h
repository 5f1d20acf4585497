// What can be computed but is most likely not what the user meant.
#pragma once

#include <string>
#include <vector>

#include "estimation/model/model.h"

namespace hookeye {

/// One sentence each: materials whose energy falls again as they are stretched (Yeoh with c3 < 0,
/// Mooney-Rivlin with c01 < 0), material frames that are orthonormal but for rounding, supports
/// that move shared nodes differently, measured forces where nothing holds the body, measured
/// points off the body, cameras that look past it, photos of which nothing counts.
std::vector<std::string> doubts(const Scene& scene);

}  // namespace hookeye
