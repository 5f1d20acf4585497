// Recipes of the blind benchmark, drawn by seed.
#pragma once

#include <string>

namespace hookeye::blind {

/// A recipe that hides `effect` ("none": nothing) in a body, a rig, a light and loads of its own.
std::string draw_recipe(const std::string& effect, unsigned seed);

}  // namespace hookeye::blind
