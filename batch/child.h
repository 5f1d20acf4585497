// The program once more, as a process of its own that works on one capture.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hookeye {

/// Set in a child's environment: the process with which it ends, whatever ends that.
inline constexpr const char* kEndsWith = "HOOKEYE_ENDS_WITH";
/// Called once by main(), before all else.
void end_with_starter();

struct ChildEnd {
  int status = 0;        ///< exit status; of one that a signal ended, 128 + the signal
  int signal = 0;        ///< 0: it ended by itself
  double seconds = 0.0;  ///< by the clock on the wall
  double cpu = 0.0;      ///< [s] of all its threads
  double memory = 0.0;   ///< [bytes] most that it held at once
};

/// A group of processes of its own: Ctrl-C of a terminal reaches the batch alone. Started, asked
/// and ended by one thread, which outlives it.
class Child {
 public:
  /// `out`, `err`: files that take what it prints. `memory` [bytes]: the address space that it may
  /// take, as `ulimit -v` limits it; 0: no limit. Throws std::runtime_error.
  Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
        const std::filesystem::path& out, const std::filesystem::path& err, double memory);
  ~Child();  ///< kills it where it runs
  Child(Child&& other) noexcept;
  Child& operator=(Child&& other) noexcept;

  /// Empty: it runs.
  std::optional<ChildEnd> ended();
  void stop() const;  ///< asks it to stop at the next safe place
  void kill() const;
  double seconds() const;                     ///< since its start
  int handle() const { return descriptor_; }  ///< readable, to poll(2), when it ends; -1: not known

 private:
  pid_t process_ = -1;
  int descriptor_ = -1;
  std::chrono::steady_clock::time_point began_;
};

}  // namespace hookeye
