#include "runs/search_worker.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <thread>

#include "capture_io/fingerprints.h"
#include "core/fingerprint.h"
#include "core/interrupted.h"
#include "runs/kept_work.h"
#include "runs/run_limits.h"
#include "runs/search.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using Seconds = std::chrono::duration<double>;
using Clock = std::chrono::steady_clock;

/// The search that this worker has followed is not there any more, or is another one.
struct SearchOver {};

/// Looks every half second whether the search is there still. What the worker is at stops soon
/// after.
class SearchWatch {
 public:
  SearchWatch(fs::path run, SearchAtWork search, const std::atomic<bool>* cancel)
      : run_(std::move(run)),
        search_(std::move(search)),
        cancel_(cancel),
        watch_(folder_on_disk(workers_folder(run_)), BeatTimes{}),
        thread_([this] { look_on(); }) {}
  ~SearchWatch() {
    leaving_ = true;
    thread_.join();
  }
  SearchWatch(const SearchWatch&) = delete;
  SearchWatch& operator=(const SearchWatch&) = delete;

  const std::atomic<bool>& over() const { return over_; }
  void check() const {
    if (cancel_ && *cancel_) throw Interrupted{};
    if (over_) throw SearchOver{};
  }

 private:
  void look_on() {
    constexpr int kTurns = 10;
    for (int turn = 0; !leaving_; ++turn) {
      if (cancel_ && *cancel_) over_ = true;
      if (turn % kTurns == 0 && !over_ && !is_there()) over_ = true;
      std::this_thread::sleep_for(Seconds(0.05));
    }
  }
  bool is_there() {
    try {
      const auto now = search_at_work(run_);
      return now && now->id == search_.id && !watch_.gone(search_.worker);
    } catch (const std::exception&) {  // half removed
      return false;
    }
  }

  const fs::path run_;
  const SearchAtWork search_;
  const std::atomic<bool>* cancel_;
  WorkerWatch watch_;
  std::atomic<bool> over_ = false, leaving_ = false;
  std::thread thread_;
};

class WorkersCrew final : public SearchCrew {
 public:
  WorkersCrew(const Run& run, Archive& archive, const std::string& made_for,
              const SearchWatch& search)
      : SearchCrew(workers_folder(run.folder()), archive),
        search_(search),
        known_(std::make_shared<Journal>(Journal::of_another(run.archive(), made_for))) {}

  bool wait() override {
    search_.check();
    if (!archive_.learn_from(known_, false)) pause();
    return true;
  }
  void share(const std::vector<std::string>& keys,
             const std::function<void(size_t)>& work) override {
    const std::string batch = batch_of(keys);
    std::optional<std::string> how;
    while (!(how = shared().read(batch))) {
      search_.check();
      pause();
    }
    if (*how != "shared\n") return;
    archive_.learn_from(known_, false);
    constexpr double kForEver = 1e300;
    work_on(
        keys, work, [&] { return search_.over().load(); }, [] { return kForEver; });
    search_.check();
  }

 private:
  const SearchWatch& search_;
  const std::shared_ptr<Journal> known_;
};

std::optional<SearchAtWork> wait_for_search(const fs::path& run, const WorkerOptions& options,
                                            const std::string& but) {
  const auto began = Clock::now();
  while (true) {
    if (options.cancel && *options.cancel) throw Interrupted{};
    if (auto search = search_at_work(run); search && search->id != but) return search;
    // A run whose search has ended has no search.json; one that was killed has the old one.
    if (!but.empty() && !fs::exists(workers_folder(run))) return {};
    if (Seconds(Clock::now() - began).count() > options.wait) return {};
    std::this_thread::sleep_for(Seconds(0.1));
  }
}

void check_same(const Run& run, const SearchAtWork& search) {
  if (fingerprint_of(archive_made_for(run)) != search.made_for)
    throw InputError({run.folder().string()},
                     "its search is another program's, or has other options than run.json tells",
                     "start the worker with the program that searches");
  const auto then = run.timeline().value("fingerprints", std::map<std::string, std::string>());
  const std::string changed = changed_since(then, fingerprints(run.capture()));
  if (!changed.empty())
    throw InputError({(run.capture().parent_path() / changed).string()},
                     "this is not what the search reads: a worker needs the same files",
                     "let this machine see the same folder, or copy the capture again");
}

/// One search, to its end, with which SearchOver or Interrupted is thrown.
void follow(const fs::path& folder, const SearchAtWork& search, const WorkerOptions& options,
            TaskTally& tally) {
  const Run run = open_run(folder, false);
  check_same(run, search);
  const Warn silent = [](const std::string&) {};  // the search has said it
  Bench bench = open_capture(run.capture(), silent, limits_of(run.timeline()));
  const SearchWatch watch(folder, search, options.cancel);
  const std::string made_for = archive_made_for(run);
  const fs::path answers = workers_folder(folder) / "answers" /
                           fmt::format("{}-{:08x}", ::getpid(), std::random_device{}());
  auto archive = std::make_shared<Archive>(std::make_unique<Journal>(answers, made_for));
  const auto crew = std::make_shared<WorkersCrew>(run, *archive, made_for, watch);
  archive->work_with(crew);
  bench.workspace.keep_in(archive);
  const auto add_up = [&] {
    tally.tasks += crew->tally().tasks, tally.seconds += crew->tally().seconds;
  };
  try {
    follow_search(run, bench, search.from, search.without, &watch.over());
    watch.check();
  } catch (...) {
    add_up();
    throw;
  }
  add_up();
  while (true) {  // the way ends here before the search writes what it came to
    watch.check();
    std::this_thread::sleep_for(Seconds(0.1));
  }
}

}  // namespace

Helped help_search(const fs::path& run, const WorkerOptions& options) {
  Helped out;
  std::string before;
  while (const auto search = wait_for_search(run, options, before)) {
    before = search->id;
    spdlog::debug("at work on the search {}", search->id);
    try {
      follow(run, *search, options, out.tally);
    } catch (const SearchOver&) {
      if (options.cancel && *options.cancel) throw Interrupted{};
    } catch (const InputError&) {
      if (search_at_work(run)) throw;  // else the folder went with the search's end
    }
    out.ended = !search_at_work(run);
    if (out.ended) return out;
  }
  if (before.empty())
    throw InputError({run.string()}, "no search is at work in this run",
                     "begin it with `hookeye discover CAPTURE -o " + run.string() +
                         "`, here or on another machine that sees this folder");
  return out;
}

}  // namespace hookeye
