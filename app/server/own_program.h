// This program again, in a process of its own: what a file does to it does not reach the server,
// and it can be ended at once.
#pragma once

#include <sys/types.h>

#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hookeye {

/// One at a time. kill() may come from any thread.
class OwnProgram {
 public:
  /// Runs it to its end and returns the document of --json, which belongs among the arguments; null
  /// where it could not be started, was ended or answered nonsense. `wanted` is asked once before
  /// it starts, so that no kill() comes too early; it may lock, and kill() must not be called
  /// inside of that lock.
  nlohmann::json run(std::vector<std::string> arguments, const std::function<bool()>& wanted);
  void kill();

 private:
  std::mutex mutex_;
  pid_t child_ = -1;
};

}  // namespace hookeye
