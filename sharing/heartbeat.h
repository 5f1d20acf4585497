// Who works in a shared folder, and who has gone. No clock of one machine is held against that of
// another: a worker counts, and whoever watches it asks by its own clock whether it counts on.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "sharing/shared_folder.h"

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

/// What stands in a worker's file after so many beats: `machine` is the boot and the name space of
/// its processes, `began` when it did in ticks since the boot.
std::string beat_text(unsigned long count, const std::string& machine, long process,
                      const std::string& began);

/// Tells which workers have gone, by their files in beats/. Asked again and again.
class WorkerWatch {
 public:
  WorkerWatch(std::shared_ptr<SharedFolder> folder, const BeatTimes& times);

  /// On this machine: its process is there no more, at two questions a second apart, so that what
  /// it had started has ended too. Elsewhere: it has not counted for `silent`.
  bool gone(const std::string& worker);
  /// When it was asked last, it was known to be there: its process is, or it has counted since it
  /// was seen first.
  bool known_alive(const std::string& worker) const;
  /// Removes the file of one that has gone.
  void forget(const std::string& worker);

 private:
  struct Seen {
    std::string text;
    double since = 0.0;  ///< [s]
    bool ended = false;  ///< its process, on this machine
    bool alive = false;  ///< for certain
  };
  std::shared_ptr<SharedFolder> folder_;
  BeatTimes times_;
  std::map<std::string, Seen> seen_;
};

}  // namespace hookeye
