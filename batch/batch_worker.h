// One worker of a batch: takes tickets, has a process work on each, tells what came of it.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "batch/batch_folder.h"
#include "sharing/leases.h"

namespace hookeye {

struct WorkOptions {
  std::filesystem::path program;  ///< that is started for every capture
  int jobs = 1;                   ///< processes at once
  int threads = 1;                ///< of each
  double memory = 0.0;            ///< [bytes] of address space of each; 0: no limit
  double timeout = 0.0;           ///< [s] for a capture; 0: none
  /// Keys of what is to be done, in this order; empty: all that the folder holds.
  std::vector<std::string> keys;
  /// Stays until others have ended what they have in hand, and takes it up where they are gone.
  /// Else it leaves when nothing waits and all others are known to be at work.
  bool wait_for_others = true;
  BeatTimes times;
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(const BatchCounts&)> progress;
  std::function<void(const std::string&)> warn;
};

/// How often a capture's process is started again where something kills it.
inline constexpr int kMostTries = 3;

/// Works until nothing is left to do. Throws Interrupted where `cancel` was set, after its
/// processes have stopped and their captures are free again; InputError where the disk is full, or
/// the program was replaced meanwhile, with what is running ended in order.
void work_on(const BatchFolder& folder, const WorkOptions& options);

}  // namespace hookeye
