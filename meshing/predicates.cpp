// Shewchuk's exact predicates, which TetGen's library carries: declared here as its header does.
#include "meshing/detail.h"

double orient3d(double* a, double* b, double* c, double* d);
void exactinit(int verbose, int no_exact, int no_filter, double x, double y, double z);

namespace hookeye::detail {

int orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  // Without the static filter, whose bound counts on a largest coordinate: beyond it the sign would
  // be taken from rounding.
  static const bool ready = [] {
    exactinit(0, 0, 1, 1.0, 1.0, 1.0);
    return true;
  }();
  (void)ready;
  Vector3d p[4] = {a, b, c, d};
  const double det = orient3d(p[0].data(), p[1].data(), p[2].data(), p[3].data());
  return det < 0 ? 1 : det > 0 ? -1 : 0;  // orient3d is positive when d lies below abc
}

}  // namespace hookeye::detail
