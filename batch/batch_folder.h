// The folder of a batch, which is all that its processes share. Beside the tickets (tickets.h):
//   batch.json    what all captures have in common
//   results/      what a worker found, under the name that the ticket had with it
//   past/KEY      of a capture that has changed since: its result counts no more
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "batch/batch_task.h"
#include "sharing/tickets.h"

namespace hookeye {

class BatchFolder {
 public:
  /// A new folder, or one with a batch of the same order. Throws InputError where it holds anything
  /// else.
  static BatchFolder make(const std::filesystem::path& folder, const BatchOrder& order);
  static BatchFolder open(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return path_; }
  const BatchOrder& order() const { return order_; }
  std::filesystem::path beats() const { return path_ / "beats"; }
  const Tickets& tickets() const { return tickets_; }

  /// False: it was there, and stays as it is. `worker`: who enrols it.
  bool enrol(const BatchTask& task, const std::string& worker) const;
  /// The same content lies elsewhere now.
  void set_capture(const std::string& key, const std::filesystem::path& capture) const;
  BatchTask task(const std::string& key) const;
  std::vector<std::string> keys() const { return tickets_.keys(); }
  /// All but those that are past, in the order of their labels.
  std::vector<BatchTask> tasks() const;
  /// Its capture has changed, or is as it was again.
  void set_past(const std::string& key, bool past) const;
  bool is_past(const std::string& key) const;
  std::set<std::string> past() const;

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

  std::filesystem::path path_;
  BatchOrder order_;
  Tickets tickets_;
};

struct BatchCounts {
  int todo = 0, running = 0, done = 0, failed = 0;  ///< running: by all workers
  int all() const { return todo + running + done + failed; }
};

/// Of the tasks that are told; of all where there are none. Those that are past do not count.
BatchCounts count(const BatchFolder& folder, const std::vector<std::string>& keys);

}  // namespace hookeye
