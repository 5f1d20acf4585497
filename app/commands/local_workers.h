// Workers of a search as processes of this machine, which end with it.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "app/scratch_folder.h"
#include "app/session.h"
#include "batch/child.h"

namespace hookeye {

class LocalWorkers {
 public:
  /// `count` of them; 0: none. They find the search of `run` once it has begun.
  LocalWorkers(int count, const std::filesystem::path& run, const Session& session);
  /// One that has failed is told; the search has gone on without it.
  void tell_failures(Session& session);

 private:
  std::optional<ScratchFolder> logs_;
  std::vector<Child> workers_;
};

}  // namespace hookeye
