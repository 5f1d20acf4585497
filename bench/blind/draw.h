// Recipes of the blind benchmark, drawn by seed.
#pragma once

#include <string>
#include <vector>

namespace hookeye::blind {

/// Names in "gravity+creep", several effects at once; empty for "none".
std::vector<std::string> effects_of(const std::string& hidden);

/// A recipe that hides the effects of `hidden` in a body, a rig, a light and loads of its own. Each
/// moves the surface by 1.5 to 3.5 px (rms) times `size`. `step_back` puts the cameras farther
/// away, as one would whose body leaves the picture.
std::string draw_recipe(const std::string& hidden, unsigned seed, double size = 1.0,
                        int step_back = 0);

}  // namespace hookeye::blind
