// How far an inspection is.
#pragma once

#include <functional>

namespace hookeye {

/// Each is told what is done, of all. Any may be empty; of any thread.
struct InspectionProgress {
  std::function<void(int done, int of)> solved;    ///< load cases, by the first guess
  std::function<void(int done, int of)> looked;    ///< photos beside the model
  std::function<void(int done, int of)> compared;  ///< load cases with the body at rest
};

}  // namespace hookeye
