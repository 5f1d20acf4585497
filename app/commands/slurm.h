// A batch's work on a cluster: one job array, whose tasks are workers on the shared folder.
#pragma once

#include <filesystem>
#include <string>

#include "app/session.h"
#include "batch/batch_folder.h"

namespace hookeye {

struct SlurmRequest {
  std::string options;  ///< of sbatch, as a shell takes them
  std::filesystem::path program;
  int jobs = 0, threads = 0;           ///< workers, and threads of each; 0: not told
  double memory = 0.0, timeout = 0.0;  ///< [bytes], [s] of a capture; 0: not told
};

/// Throws InputError where sbatch is not there, or refuses; nothing is lost then.
void send_to_slurm(const BatchFolder& folder, const SlurmRequest& request, Session& session);

}  // namespace hookeye
