#include "runs/search_worker.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "capture_io/fingerprints.h"
#include "core/fingerprint.h"
#include "core/input_error.h"
#include "core/own_file.h"
#include "core/work_clock.h"
#include "estimation/fit/archive.h"
#include "runs/failed.h"
#include "runs/kept_work.h"
#include "runs/run_limits.h"
#include "runs/search.h"
#include "runs/versions.h"
#include "runs/work_log.h"
#include "sharing/tickets.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kAskEvery = std::chrono::milliseconds(200);

double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

/// What is left of a search that nobody is in: answers may be there still.
void clear_left_over(const fs::path& folder, const std::string& mark) {
  std::error_code failed;
  const auto notice = notice_in(folder);
  if (!notice || notice->made_for != mark)
    fs::remove_all(folder, failed);
  else if (fs::is_empty(folder / "beats", failed) && !failed)
    for (const std::string& name : Tickets::folders()) fs::remove_all(folder / name, failed);
}

/// Throws where this process would not come to the answers of the search.
void demand_same(const SearchNotice& notice, const Run& run) {
  const std::string folder = run.folder().string();
  if (notice.program != fingerprint_of_file(own_file()))
    throw InputError(
        {folder},
        fmt::format("its search is run by another program, {} (this is {})", notice.version,
                    notice.version == version_text() ? "another build of it" : version_text()),
        "start the worker with the program that runs the search");
  const auto now = fingerprints(run.capture());
  const auto then = run.timeline().value("fingerprints", std::map<std::string, std::string>());
  if (now.empty())
    throw InputError({run.capture().string()}, "the search's capture cannot be read here",
                     "workers need the capture under the same path as the search");
  if (const std::string changed = changed_since(then, now); !changed.empty())
    throw InputError({(run.capture().parent_path() / changed).string()},
                     fmt::format("this differs from what the search in {} sees", folder),
                     "give this machine the same files, or undo the change");
  if (notice.made_for != fingerprint_of(made_for(run)))
    throw InputError({folder}, "its search was begun with other options or effects",
                     "start the worker once the search has begun");
}

/// Sets a flag where a worker is to stop, and knows why.
class StopWatch {
 public:
  StopWatch(const WorkerRequest& wanted, const SharedSearch& shared, SearchNotice notice)
      : wanted_(wanted), shared_(shared), notice_(std::move(notice)), thread_([this] { run(); }) {}
  StopWatch(const StopWatch&) = delete;
  StopWatch& operator=(const StopWatch&) = delete;
  ~StopWatch() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    woken_.notify_all();
    thread_.join();
  }
  const std::atomic<bool>& stopped() const { return stopped_; }
  bool changed() const { return changed_; }  ///< the search was begun anew, from elsewhere
  const std::string& why() const { return why_; }

 private:
  /// "": it goes on.
  std::string reason() {
    const auto now = notice_in(workers_folder(wanted_.run));
    if (wanted_.cancel && *wanted_.cancel) return "stopped";
    if (now && now->ended) return "the search has ended";
    if (now && now->from &&
        (now->from != notice_.from || now->without != notice_.without ||
         now->made_for != notice_.made_for)) {
      changed_ = true;
      return "the search was begun anew";
    }
    if (now && shared_.at_work(now->master))
      seen_ = Clock::now();
    else if (seconds_since(seen_) > wanted_.wait)
      return "nobody runs the search any more";
    return "";
  }
  void run() {
    std::unique_lock lock(mutex_);
    while (!woken_.wait_for(lock, kAskEvery, [&] { return ending_; })) {
      why_ = reason();
      if (why_.empty()) continue;
      stopped_ = true;
      return;
    }
  }

  const WorkerRequest& wanted_;
  const SharedSearch& shared_;
  const SearchNotice notice_;
  Clock::time_point seen_ = Clock::now();
  std::atomic<bool> stopped_{false};
  std::atomic<bool> changed_{false};
  std::string why_;
  std::mutex mutex_;
  std::condition_variable woken_;
  bool ending_ = false;
  std::thread thread_;
};

/// A search that is at work and has told where it begins. Empty: there was none for so long.
std::optional<SearchNotice> wait_for_search(const WorkerRequest& wanted) {
  const auto began = Clock::now();
  const fs::path folder = workers_folder(wanted.run);
  while (true) {
    if (wanted.cancel && *wanted.cancel) throw Interrupted{};
    const auto notice = notice_in(folder);
    std::error_code ignored;
    if (notice && !notice->ended && notice->from &&
        fs::exists(folder / "beats" / notice->master, ignored))
      return notice;
    if (seconds_since(began) > wanted.wait) return {};
    std::this_thread::sleep_for(kAskEvery);
  }
}

void log_work(const fs::path& run, size_t steps, const WorkTable& before) {
  std::ofstream(run / kWorkFile, std::ios::app)
      << work_line({steps, steps, worked_since(before), true}) + "\n"
      << std::flush;
}

bool over(const fs::path& folder) {
  const auto notice = notice_in(folder);
  return !notice || notice->ended;
}

/// The way of the search, as far as it gets.
void take_the_way(const WorkerRequest& wanted, const Run& run, const SearchNotice& notice,
                  const std::shared_ptr<SharedSearch>& shared, WorkerEnd& out, bool& anew) {
  const WorkTable before = worked();
  Bench bench = open_capture(
      run.capture(), [](const std::string&) {}, limits_of(run.timeline()));
  const auto archive =
      std::make_shared<Archive>(std::make_unique<Journal>(shared->own_journal(), made_for(run)));
  archive->share(shared, false);
  bench.workspace.keep_in(archive);
  const StopWatch watch(wanted, *shared, notice);
  DiscoverOptions options;
  options.fit.cancel = options.diagnosis.cancel = &watch.stopped();
  options.diagnosis.without = notice.without;
  options.scored = false;
  out.why = "the search is at its end";
  try {
    search_anew(run, bench, *notice.from, options, {});
  } catch (const Interrupted&) {
    out.why = watch.why();
  } catch (const Failed&) {
    out.why = watch.stopped() ? watch.why() : "the search ends without an answer";
  }
  for (const auto& [kind, tally] : archive->tallies()) out.answers += tally.kept;
  log_work(run.folder(), run.steps().size(), before);
  anew = watch.changed();
}

/// One search, from where it began. False: it was begun anew meanwhile.
bool help(const WorkerRequest& wanted, const SearchNotice& notice, WorkerEnd& out) {
  const Run run = open_run(wanted.run, false);
  demand_same(notice, run);
  if (notice.processor != processor_mark() && wanted.warn)
    wanted.warn(
        "this machine's processor is of another kind than that of the search: last digits of "
        "what is worked out here may differ from what would come out there");
  const fs::path folder = workers_folder(run.folder());
  bool anew = false;
  out.began = true;
  try {
    const auto shared = std::make_shared<SharedSearch>(
        folder, run.archive(), SharedSearch::Options{made_for(run), wanted.threads});
    take_the_way(wanted, run, notice, shared, out, anew);
  } catch (const InputError&) {  // the last one who left took the folder along
    if (!over(folder)) throw;
    out.why = "the search has ended";
  }
  return !anew;
}

}  // namespace

OpenSearch::OpenSearch(const Run& run, int threads, std::vector<std::string> without,
                       const std::atomic<bool>* cancel)
    : folder_(workers_folder(run.folder())), cancel_(cancel) {
  const std::string holds_for = made_for(run);
  clear_left_over(folder_, fingerprint_of(holds_for));
  shared_ = std::make_shared<SharedSearch>(folder_, fs::path(),
                                           SharedSearch::Options{holds_for, threads});
  notice_ = {shared_->worker(),  fingerprint_of(holds_for),
             version_text(),     fingerprint_of_file(own_file()),
             processor_mark(),   {},
             std::move(without), false};
}

OpenSearch::~OpenSearch() {
  try {
    end();
  } catch (const std::exception&) {  // they see that this process has gone
  }
  shared_.reset();
  std::error_code failed;
  const bool needless = std::filesystem::is_empty(folder_ / "answers", failed);
  if (notice_.ended || (needless && !failed)) remove_workers_folder(folder_);
}

void OpenSearch::end() {
  notice_.ended = !(cancel_ && *cancel_);
  shared_->tell(notice_);
}

void OpenSearch::begun(int from) {
  notice_.from = from;
  shared_->tell(notice_);
}

WorkerEnd work_for_search(const WorkerRequest& wanted) {
  const auto began = Clock::now();
  WorkerEnd out;
  while (true) {
    const auto notice = wait_for_search(wanted);
    if (!notice) {
      if (out.why.empty())
        out.why = fmt::format("no search was at work there for {:g} s", wanted.wait);
      break;
    }
    if (help(wanted, *notice, out)) break;
  }
  const auto notice = notice_in(workers_folder(wanted.run));
  if (notice && notice->ended) remove_workers_folder(workers_folder(wanted.run));
  if (wanted.cancel && *wanted.cancel && !(notice && notice->ended)) throw Interrupted{};
  out.seconds = seconds_since(began);
  return out;
}

}  // namespace hookeye
