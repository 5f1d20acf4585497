// Who works in a batch's folder, and who has gone. No clock of one machine is held against that of
// another: a worker counts, and whoever watches it asks by its own clock whether it counts on.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

namespace hookeye {

/// [s] How often a worker counts, and how long one that is out of sight may be silent. For a worker
/// on the same machine its process is asked instead.
struct BeatTimes {
  double beat = 5.0, silent = 60.0;
};

/// A worker in `folder`, as long as the object lives: its file holds the machine, the process and
/// a count.
class Heartbeat {
 public:
  /// Throws InputError where the folder cannot be written.
  Heartbeat(const std::filesystem::path& folder, const BeatTimes& times);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

  const std::string& worker() const;  ///< a name that no other has: HOST-PROCESS-RANDOM

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Tells which workers have gone. Asked again and again.
class WorkerWatch {
 public:
  WorkerWatch(std::filesystem::path folder, const BeatTimes& times);

  /// On this machine: its process is there no more, at two questions a second apart, so that what
  /// it had started has ended too. Elsewhere: it has not counted for `silent`.
  bool gone(const std::string& worker);
  /// When it was asked last, it was known to be there: its process is, or it has counted since it
  /// was seen first.
  bool known_alive(const std::string& worker) const;
  /// Removes the file of one that has gone.
  void forget(const std::string& worker);

 private:
  using Clock = std::chrono::steady_clock;
  struct Seen {
    std::string text;
    Clock::time_point since;
    bool ended = false;  ///< its process, on this machine
    bool alive = false;  ///< for certain
  };
  std::filesystem::path folder_;
  BeatTimes times_;
  std::map<std::string, Seen> seen_;
};

}  // namespace hookeye
