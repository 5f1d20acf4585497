// The folder of a batch, which is all that its processes share. A task's state is where its ticket
// lies: one file, which moves by rename(2), so that it is never in two places and never in none.
//   batch.json    what all captures have in common
//   tasks/KEY     what is to be done
//   new/          tickets of tasks that are being enrolled
//   todo/KEY.TRIES   leased/KEY.TRIES@WORKER   done/KEY.TRIES@WORKER   failed/KEY.TRIES@WORKER
//   results/      what a worker found, under the name that the ticket had with it
//   beats/WORKER  who is at work (heartbeat.h)
//   past/KEY      of a capture that has changed since: its result counts no more
// No file is locked: locks of network file systems are not to be relied on, renames are.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "batch/batch_task.h"

namespace hookeye {

enum class TicketPlace { todo, leased, done, failed };

struct Ticket {
  std::string key;
  int tries = 0;       ///< how often its process was killed
  std::string worker;  ///< who has it, or had; "": nobody yet
  /// "KEY.TRIES@WORKER".
  std::string name() const;
};

class BatchFolder {
 public:
  /// A new folder, or one with a batch of the same order. Throws InputError where it holds anything
  /// else.
  static BatchFolder make(const std::filesystem::path& folder, const BatchOrder& order);
  static BatchFolder open(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return path_; }
  const BatchOrder& order() const { return order_; }
  std::filesystem::path beats() const { return path_ / "beats"; }

  /// False: it was there, and stays as it is. `worker`: who enrols it.
  bool enrol(const BatchTask& task, const std::string& worker) const;
  /// Tickets whose enrolling was cut short, by workers of whom `gone` says so.
  template <class Gone>
  void finish_enrolling(const Gone& gone) const {
    for (const std::string& name : names_in("new")) finish_one(name, gone(holder_of(name)));
  }
  /// The same content lies elsewhere now.
  void set_capture(const std::string& key, const std::filesystem::path& capture) const;
  BatchTask task(const std::string& key) const;
  std::vector<std::string> keys() const { return names_in("tasks"); }
  /// All but those that are past, in the order of their labels.
  std::vector<BatchTask> tasks() const;
  /// Its capture has changed, or is as it was again.
  void set_past(const std::string& key, bool past) const;
  bool is_past(const std::string& key) const;
  std::set<std::string> past() const;

  std::vector<Ticket> tickets(TicketPlace place) const;
  /// False: somebody was faster. Exactly one of those who try gets it.
  bool move(const Ticket& ticket, TicketPlace from, const Ticket& as, TicketPlace to) const;
  bool is_at(const Ticket& ticket, TicketPlace place) const;

  /// Written before the ticket is moved to `done` or `failed`.
  void store_result(const Ticket& ticket, const nlohmann::json& result) const;
  /// Null where there is none that can be read.
  nlohmann::json result(const Ticket& ticket) const;
  void drop_result(const Ticket& ticket) const;

  /// Where a task's files lie: runs/NAME, logs/NAME.json and .txt, reports/NAME.html.
  std::filesystem::path run_of(const BatchTask& task) const;
  std::filesystem::path log_of(const BatchTask& task, const std::string& extension) const;
  std::filesystem::path report_of(const BatchTask& task) const;

 private:
  BatchFolder(std::filesystem::path path, BatchOrder order);
  std::vector<std::string> names_in(const std::string& folder) const;
  static std::string holder_of(const std::string& name);
  void finish_one(const std::string& name, bool gone) const;
  std::filesystem::path file_of(const Ticket& ticket, TicketPlace place) const;

  std::filesystem::path path_;
  BatchOrder order_;
};

struct BatchCounts {
  int todo = 0, running = 0, done = 0, failed = 0;  ///< running: by all workers
  int all() const { return todo + running + done + failed; }
};

/// Of the tasks that are told; of all where there are none. Those that are past do not count.
BatchCounts count(const BatchFolder& folder, const std::vector<std::string>& keys);

}  // namespace hookeye
