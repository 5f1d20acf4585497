// The processes that work on one search, and the folder RUN/workers that they share. All take the
// search's way; its independent tasks have tickets (sharing/), and who works one out writes what it
// came to where the others read it. Whoever works, and however many, every answer has the same
// bits.
//   search.json    the search that is at work
//   batches/KEY    tasks that are independent: "shared", or "alone" where nobody else was there
//   answers/NAME   what a worker has worked out (journal.h)
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/journal.h"
#include "estimation/fit/crew.h"
#include "runs/bench.h"
#include "sharing/heartbeat.h"
#include "sharing/tickets.h"

namespace hookeye {

/// RUN/workers.
std::filesystem::path workers_folder(const std::filesystem::path& run);

/// The search that is at work in a run.
struct SearchAtWork {
  std::string id;      ///< another one, or the same begun again, has another
  std::string worker;  ///< whose heartbeat is the search's own
  std::string made_for;
  int from = -1;  ///< step that it goes on from
  std::vector<std::string> without;
};
/// Empty: there is none.
std::optional<SearchAtWork> search_at_work(const std::filesystem::path& run);

/// Tasks of a search that were worked out by one process.
struct TaskTally {
  int tasks = 0;
  double seconds = 0.0, longest = 0.0;
};

/// What search and workers have in common.
class SearchCrew : public Crew {
 public:
  const TaskTally& tally() const { return tally_; }

 protected:
  /// `folder`: workers_folder(), which is there.
  SearchCrew(const std::filesystem::path& folder, Archive& archive);
  /// Works on what nobody else has until all of `keys` are done, or stop() says so. `patience` [s]:
  /// how long it waits at most with nothing to do.
  void work_on(const std::vector<std::string>& keys, const std::function<void(size_t)>& work,
               const std::function<bool()>& stop, const std::function<double()>& patience);
  void pause() const;

  SharedFolder& shared() const { return tickets_.folder(); }
  static std::string batch_of(const std::vector<std::string>& keys);

  const std::filesystem::path folder_;
  const Tickets tickets_;
  const Heartbeat heartbeat_;
  Archive& archive_;

 private:
  bool all_done(const std::vector<std::string>& keys) const;
  TaskTally tally_;
};

/// The search itself: while the object lives, workers may join, and what they have worked out goes
/// into the archive of `bench`, which has one.
class SharedSearch {
 public:
  /// `from`, `without`: as SearchAtWork. `cancel`: may be null.
  SharedSearch(const Run& run, Bench& bench, int from, const std::vector<std::string>& without,
               const std::atomic<bool>* cancel);
  /// Where the user has stopped it, workers keep what they have in hand; else their folder goes.
  ~SharedSearch();
  SharedSearch(const SharedSearch&) = delete;
  SharedSearch& operator=(const SharedSearch&) = delete;

 private:
  class Own;
  const std::filesystem::path folder_;
  Archive* archive_;
  const std::atomic<bool>* cancel_;
  std::shared_ptr<Own> crew_;
};

}  // namespace hookeye
