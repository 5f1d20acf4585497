// A batch from its list to its index, for the command line and for Python.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "batch/batch_folder.h"
#include "batch/batch_worker.h"
#include "batch/capture_list.h"

namespace hookeye {

struct EnrolOptions {
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(const std::string& label)> progress;  ///< after each that was read
  std::function<void(const std::string& sentence)> warn;
};
/// Enrols all that is listed: those that are there stay as they are, and what has changed since
/// counts anew. Returns the keys in the list's order. Throws InputError; Interrupted where `cancel`
/// is set.
std::vector<std::string> enrol(const BatchFolder& folder, const std::vector<ListedCapture>& list,
                               const EnrolOptions& options);

/// What has failed waits again; `keys` empty: of all.
void try_failed_again(const BatchFolder& folder, const std::vector<std::string>& keys);

/// What of the machine a batch may take; 0: as it sees fit.
struct MachineShare {
  int jobs = 0, threads = 0;
  double memory = 0.0;  ///< [bytes] of a capture
};
/// As many processes as there are cores for, captures (`open` of them), and memory where it is
/// told.
void share_machine(const MachineShare& wanted, int open, WorkOptions& work);

/// work_on(), with the index written at its end, also of what was stopped.
void work_and_index(const BatchFolder& folder, const WorkOptions& work);

}  // namespace hookeye
