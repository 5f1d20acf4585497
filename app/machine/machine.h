// What the system tells of the machine.
#pragma once

#include <filesystem>
#include <string>

namespace hookeye {

struct Machine {
  std::string processor;          ///< "AMD EPYC 7B13"; empty: not told
  int cores = 0;                  ///< of the machine
  int threads = 0;                ///< that this program uses: its share of them, and --threads
  double memory = 0.0;            ///< [bytes]; the limit of a container, where that is less
  double memory_free = 0.0;       ///< [bytes]
  std::filesystem::path here;     ///< the working folder
  double disk_free = 0.0;         ///< [bytes] there
  std::filesystem::path scratch;  ///< for temporary files: TMPDIR, or /tmp
  double scratch_free = 0.0;      ///< [bytes]
};

/// What cannot be learned stays empty or 0.
Machine this_machine();

}  // namespace hookeye
