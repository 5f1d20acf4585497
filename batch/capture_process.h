// A capture in the hands of a worker: the process that works on it, then that of its page.
#pragma once

#include <nlohmann/json.hpp>

#include "batch/batch_folder.h"
#include "batch/batch_worker.h"
#include "batch/child.h"

namespace hookeye {

/// Where a capture's processes are.
enum class CaptureState {
  running,
  finished,  ///< result() is whole
  stopped,   ///< as it was asked to
  killed,    ///< by somebody, or by a system that has no memory left
  no_room,   ///< the disk is full
};

/// Begins with its construction, which throws std::runtime_error where the program cannot be
/// started. Ends with the object.
class CaptureProcess {
 public:
  CaptureProcess(const BatchFolder& folder, const WorkOptions& options, Ticket ticket,
                 BatchTask task, nlohmann::json result);

  const Ticket& ticket() const { return ticket_; }
  const BatchTask& task() const { return task_; }
  nlohmann::json& result() { return result_; }
  const Child& child() const { return child_; }
  int signal() const { return signal_; }  ///< of one that was killed
  bool timed_out() const { return timed_out_; }

  /// What came of it. `stopping`: all are to stop.
  CaptureState settle(bool stopping);
  /// Asks it to stop where it is to, or takes too long; kills it where it does not.
  void look_after(bool stopping);
  void kill() const { child_.kill(); }

 private:
  CaptureState settle_capture(const ChildEnd& end, bool stopping);
  bool add_finding(bool stopping);
  void settle_report(const ChildEnd& end, bool stopping) const;

  const BatchFolder* folder_;
  const WorkOptions* options_;
  Ticket ticket_;
  BatchTask task_;
  nlohmann::json result_;
  Child child_;
  bool reporting_ = false;  ///< the run is done, its page is being written
  bool timed_out_ = false;
  int signal_ = 0;
  double stopping_since_ = -1.0;  ///< [s] of the child's life; below 0: it is not to stop
};

}  // namespace hookeye
