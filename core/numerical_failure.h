// The numbers failed (no equilibrium, no convergence): exit status 3, never a crash.
#pragma once

#include <string>

namespace hookeye {

/// Returned (never thrown) by solvers: where it stopped and why.
struct NumericalFailure {
  std::string example;         ///< name of the example, or ""
  double load_fraction = 0.0;  ///< largest fraction of the load at which equilibrium was found
  std::string reason;          ///< one sentence, with the element where one is at fault
};

/// It ended because somebody asked for that.
inline bool cancelled(const NumericalFailure& failure) { return failure.reason == "cancelled"; }

}  // namespace hookeye
