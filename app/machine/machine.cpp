#include "app/machine/machine.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// What follows "NAME" and a colon in the first line of `file` that begins with it.
std::string told_in(const char* file, const std::string& name) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(name)) continue;
    const size_t colon = line.find(':');
    const size_t begin = line.find_first_not_of(" \t", colon + 1);
    if (colon != std::string::npos && begin != std::string::npos) return line.substr(begin);
  }
  return {};
}

/// [bytes] of a line "MemTotal:   24000000 kB"; 0: none.
double memory_told(const std::string& name) {
  double kilobytes = 0.0;
  std::istringstream(told_in("/proc/meminfo", name)) >> kilobytes;
  return 1024.0 * kilobytes;
}

/// [bytes] that a container allows; 0: no limit.
double container_limit() {
  double bytes = 0.0;
  std::ifstream("/sys/fs/cgroup/memory.max") >> bytes;  // "max": none
  return bytes;
}

double free_in(const fs::path& folder) {
  std::error_code failed;
  const auto space = fs::space(folder, failed);
  return failed ? 0.0 : static_cast<double>(space.available);
}

}  // namespace

Machine this_machine() {
  Machine out;
  out.processor = told_in("/proc/cpuinfo", "model name");
  out.cores = static_cast<int>(std::thread::hardware_concurrency());
  out.threads = static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  out.memory = memory_told("MemTotal");
  out.memory_free = memory_told("MemAvailable");
  if (const double limit = container_limit(); limit > 0.0 && limit < out.memory) {
    out.memory = limit;
    out.memory_free = std::min(out.memory_free, limit);
  }
  std::error_code failed;
  out.here = fs::current_path(failed);
  out.disk_free = free_in(out.here);
  out.scratch = fs::temp_directory_path(failed);
  out.scratch_free = free_in(out.scratch);
  return out;
}

}  // namespace hookeye
