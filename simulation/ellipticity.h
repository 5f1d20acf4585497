// Loss of ellipticity: where a material at a given strain has no resistance against a shear band or
// a wrinkle, whatever the supports. Convexity in E does not exclude it.
#pragma once

#include "simulation/energy_term.h"

namespace hookeye {

/// The smallest value of (m (x) n) : dP/dF : (m (x) n) over unit m (deformed) and n (rest): the
/// smallest eigenvalue of the acoustic tensor over all directions (strong ellipticity, Marsden and
/// Hughes 1983, 4.1.6) [stress]. Not positive: ellipticity is lost.
struct Ellipticity {
  double smallest = 0.0;
  Eigen::Vector3d m, n;
};
/// `starts`: directions from which the search descends. `roughly`: to 1e-5 of |dP/dF|, several
/// times as fast.
Ellipticity ellipticity(const Matrix9d& dP_dF, int starts = 40, bool roughly = false);

}  // namespace hookeye
