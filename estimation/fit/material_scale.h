// What a fitted stiffness rests on: pictures tell shapes, and only a force tells how stiff.
#pragma once

#include <string>
#include <vector>

#include "estimation/fit/fit.h"

namespace hookeye {

/// Sentences: which forces fix the scale of the moduli (prescribed, measured, the weight), that the
/// photos fix only ratios where there is none, and which of them were not fitted.
std::vector<std::string> what_fixes_the_scale(const Scene& scene, const Fitted& fitted);

}  // namespace hookeye
