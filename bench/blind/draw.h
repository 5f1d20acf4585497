// Recipes of the blind benchmark, drawn by seed.
#pragma once

#include <string>
#include <vector>

namespace hookeye::blind {

/// Names in "gravity+creep", several effects at once; empty for "none".
std::vector<std::string> effects_of(const std::string& hidden);

struct Drawing {
  /// Times 1.5 to 3.5 px (rms), by which each hidden effect moves the surface; what moves nothing
  /// has one to two typical changes times this.
  double size = 1.0;
  /// Photos of 200 x 260 px, a coarser mesh and two examples less: a search takes seconds, not
  /// minutes, so that hundreds of captures can be looked at.
  bool small = false;
  int step_back = 0;  ///< puts the cameras farther away, as one would whose body leaves the picture
};

/// A recipe that hides the effects of `hidden` in a body, a rig, a light and loads of its own.
std::string draw_recipe(const std::string& hidden, unsigned seed, const Drawing& drawing);

}  // namespace hookeye::blind
