// `hookeye discover --workers N`: processes on this machine that help a search.
#pragma once

#include <filesystem>
#include <vector>

#include "app/session.h"
#include "batch/child.h"

namespace hookeye {

/// That this process may use.
int threads_here();

/// They begin with the object and end with it.
class LocalWorkers {
 public:
  /// On the search in `run`, which has its folder of workers. Throws std::runtime_error where the
  /// program cannot be started.
  LocalWorkers(const std::filesystem::path& run, int count, Session& session);
  /// Waits for them, once the search has told that it ended.
  void end();

 private:
  std::filesystem::path log_of(size_t worker) const;
  std::filesystem::path folder_;
  std::vector<Child> children_;
  Session& session_;
};

}  // namespace hookeye
