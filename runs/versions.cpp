#include "runs/versions.h"

#include <algorithm>
#include <string>

#include "described.h"  // made by cmake/describe.cmake

namespace hookeye {

nlohmann::json versions() {
  nlohmann::json out = {{"hookeye", HOOKEYE_VERSION}, {"compiler", "GCC " __VERSION__}};
  const std::string described = HOOKEYE_DESCRIBED;
  if (!described.empty()) out["git"] = described;
  // "Ceres=2.1.0 Eigen=3.4.0", told by CMake: each library's headers stand in one file alone.
  const std::string all = HOOKEYE_LIBRARIES;
  for (size_t at = 0; at < all.size();) {
    const size_t end = std::min(all.find(' ', at), all.size());
    const std::string one = all.substr(at, end - at);
    const size_t equals = one.find('=');
    if (equals != std::string::npos) out[one.substr(0, equals)] = one.substr(equals + 1);
    at = end + 1;
  }
  return out;
}

std::string version_text() {
  const std::string version = HOOKEYE_VERSION, described = HOOKEYE_DESCRIBED;
  if (described.empty() || described == "v" + version) return version;
  return version + " (" + described + ")";
}

}  // namespace hookeye
