// Whether a helper is there and can be loaded, without asking it anything.
#pragma once

#include <string>

namespace hookeye {

struct HelperCheck {
  bool there = false;   ///< the program libexec/hookeye/NAME exists
  bool loads = false;   ///< it starts, with all libraries that it needs
  std::string missing;  ///< the library that it lacks ("libgmsh.so.4.8"); empty: none, or not known
  double seconds = 0.0;  ///< to start it
};

/// Starts it once, with nothing to answer. False twice where there is no folder of helpers.
HelperCheck check_helper(const std::string& name);

}  // namespace hookeye
