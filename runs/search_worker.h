// Help for a search that runs in another process, on this machine or on another one that sees the
// same folder.
#pragma once

#include <atomic>
#include <filesystem>

#include "runs/search_crew.h"

namespace hookeye {

struct WorkerOptions {
  double wait = 60.0;  ///< [s] for a search to begin, or to be taken up again where it was killed
  const std::atomic<bool>* cancel = nullptr;
};

/// What came of it.
struct Helped {
  TaskTally tally;
  bool ended = false;  ///< the search has ended; else it has gone, and did not come back
};

/// Works on what the search of this run shares out, until it ends. Throws InputError where no
/// search is there within `wait`, or where it is another program's or another capture's;
/// Interrupted where `cancel` was set.
Helped help_search(const std::filesystem::path& run, const WorkerOptions& options);

}  // namespace hookeye
