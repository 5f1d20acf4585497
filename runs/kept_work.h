// Work that outlives its process: what fits, trials and diagnoses of a run have come to.
#pragma once

#include <atomic>

#include "core/work_clock.h"
#include "runs/bench.h"
#include "runs/work_log.h"

namespace hookeye {

class SharedWork;

/// What answers hold for, as a text: another program, another capture, other options, or other
/// effects beside the program's own come to others. Of `run` as it is.
std::string made_for(const Run& run);

/// While it lives, what the bench works out is kept in RUN/archive as it comes, and what is there
/// is not worked out again: a command that was stopped, whatever stopped it, takes up where it was.
/// The run is open for writing, and outlives it.
class KeptWork {
 public:
  /// `cancel`: set where the user stopped the work; may be null.
  /// `others` answer, too; may be null.
  KeptWork(const Run& run, Bench& bench, const std::atomic<bool>* cancel,
           std::shared_ptr<SharedWork> others = nullptr);
  KeptWork(const KeptWork&) = delete;
  KeptWork& operator=(const KeptWork&) = delete;
  /// Of a run without a step nothing stays, unless the user stopped it. Else a line of
  /// RUN/work.jsonl tells where the time went (work_of()).
  ~KeptWork();

  bool from_before() const { return from_before_; }  ///< something was there

 private:
  const Run& run_;
  Bench& bench_;
  const std::atomic<bool>* cancel_;
  bool from_before_;
  WorkTable before_ = worked();
  size_t first_step_;
};

}  // namespace hookeye
