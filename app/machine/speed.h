// How fast this machine works: equilibria and pictures of a block, as a fit needs them.
#pragma once

namespace hookeye {

struct Speed {
  int unknowns = 0;    ///< of one equilibrium
  int equilibria = 0;  ///< solved, several at a time
  double equilibria_s = 0.0;
  double megapixels = 0.0;  ///< of pictures rendered with their derivatives
  double pictures_s = 0.0;
  double seconds = 0.0;  ///< in all, with meshing
};

/// A few seconds of all threads. Throws Failed, Interrupted, and InputError where a helper or a
/// temporary folder is missing.
Speed measure_speed();

}  // namespace hookeye
