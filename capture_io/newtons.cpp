#include "capture_io/newtons.h"

namespace hookeye {

double newtons(const Units& units) {
  if (units.force == "mN") return 1e-3;
  if (units.force == "kN") return 1e3;
  if (units.force == "uN") return 1e-6;
  return 1.0;
}

}  // namespace hookeye
