// A process that helps the search in a run: it takes the same way, and works out what nobody else
// is at. It writes no step.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "runs/bench.h"
#include "runs/shared_search.h"

namespace hookeye {

/// The side of the process that runs the search and writes the run: others may help it, as long as
/// the object lives.
class OpenSearch {
 public:
  /// `run` is open for writing; `threads` of this machine. `cancel`: the search was stopped, and
  /// may go on later; may be null.
  OpenSearch(const Run& run, int threads, std::vector<std::string> without,
             const std::atomic<bool>* cancel);
  ~OpenSearch();
  OpenSearch(const OpenSearch&) = delete;
  OpenSearch& operator=(const OpenSearch&) = delete;

  const std::shared_ptr<SharedSearch>& shared() const { return shared_; }
  void begun(int from);  ///< SearchRequest::begun
  void end();            ///< tells those who help that there is no more to do

 private:
  std::filesystem::path folder_;
  std::shared_ptr<SharedSearch> shared_;
  SearchNotice notice_;
  const std::atomic<bool>* cancel_;
};

struct WorkerRequest {
  std::filesystem::path run;
  int threads = 1;     ///< of this machine, shared with those at work on the same search
  double wait = 60.0;  ///< [s] for a search to begin, or to go on
  const std::atomic<bool>* cancel = nullptr;
  Warn warn;
};

struct WorkerEnd {
  bool began = false;  ///< there was a search
  std::string why;     ///< "the search has ended"
  int answers = 0;     ///< that it worked out
  double seconds = 0.0;
};

/// Until the search ends. Throws InputError where the search is of another program or sees another
/// capture, Interrupted where it was stopped.
WorkerEnd work_for_search(const WorkerRequest& wanted);

}  // namespace hookeye
