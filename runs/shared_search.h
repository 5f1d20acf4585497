// One search by several processes: who is at which question, in RUN/workers.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/fit/shared_work.h"
#include "sharing/heartbeat.h"

namespace hookeye {

/// What a search tells those who help it: RUN/workers/search.json.
struct SearchNotice {
  std::string master;            ///< its heartbeat
  std::string made_for;          ///< mark of what its answers hold for (made_for(), kept_work.h)
  std::string version, program;  ///< in words; mark of the file
  std::string processor;         ///< mark of what it can: others may round otherwise
  std::optional<int> from;       ///< the step that it began from, -1: none; empty: not known yet
  std::vector<std::string> without;
  bool ended = false;
  bool operator==(const SearchNotice&) const = default;
};
/// Empty: there is none, or it is damaged.
std::optional<SearchNotice> notice_in(const std::filesystem::path& folder);

/// Mark of this machine's kind of processor.
std::string processor_mark();

/// tickets (sharing/tickets.h), beats/WORKER, answers/WORKER (journals), search.json. Questions are
/// tickets; locks are not used, nor is any clock held against another's.
class SharedSearch final : public SharedWork {
 public:
  struct Options {
    std::string made_for;  ///< what the journals hold for
    int threads = 1;       ///< of this machine, shared with those at work on it
    BeatTimes times = {};
  };
  /// A process in the folder, as long as it lives. `archive`: the journal that is not in it, of the
  /// process that began the search; empty: this is that one, and makes the folder. Throws
  /// InputError where it cannot be written.
  SharedSearch(std::filesystem::path folder, std::filesystem::path archive, Options options);
  ~SharedSearch() override;
  SharedSearch(const SharedSearch&) = delete;
  SharedSearch& operator=(const SharedSearch&) = delete;

  bool others() override;
  const std::vector<std::unique_ptr<JournalReader>>& journals() override;
  bool claim(const std::string& key) override;
  void finish(const std::string& key, bool answered) override;
  bool answered(const std::string& key) override;
  void wait() override;

  std::string worker() const;
  std::filesystem::path own_journal() const;
  /// False: the process of that name has gone.
  bool at_work(const std::string& worker) const;
  void tell(const SearchNotice& notice) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The folder of a run.
std::filesystem::path workers_folder(const std::filesystem::path& run);
/// Removes it where nobody is in it; those who have just gone are waited for.
void remove_workers_folder(const std::filesystem::path& folder);

}  // namespace hookeye
