#include "runs/shared_search.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "core/fingerprint.h"
#include "core/input_error.h"
#include "core/json_file.h"
#include "core/text_file.h"
#include "sharing/leases.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kNoticeFile = "search.json";
constexpr double kLostAfter = 5.0;           // [s] from "answered" until the answer is to be seen
constexpr double kSettleEvery = 0.2;         // [s] how often threads are shared out anew
constexpr int kShortest = 1, kLongest = 20;  // [ms] of a wait

/// "HOST" of "HOST-PROCESS-RANDOM".
std::string host_of(const std::string& worker) {
  const size_t last = worker.rfind('-');
  return worker.substr(0, last == std::string::npos ? 0 : worker.rfind('-', last - 1));
}

std::string worker_of(const std::string& ticket) {
  const size_t at = ticket.find('@');
  return at == std::string::npos ? "" : ticket.substr(at + 1);
}

std::vector<std::string> names_in(SharedFolder& folder, const std::string& name) {
  try {
    return folder.names(name);
  } catch (const fs::filesystem_error&) {
    return {};  // it was removed
  }
}

}  // namespace

struct SharedSearch::Impl {
  fs::path folder, archive;
  Options options;
  std::shared_ptr<SharedFolder> shared;
  Tickets tickets;
  Heartbeat heartbeat;
  Leases leases;
  WorkerWatch watch;  ///< for others()
  std::vector<std::unique_ptr<JournalReader>> journals;
  std::set<std::string> read;            ///< their files
  std::set<std::string> held;            ///< keys that are this process' turn
  std::map<std::string, double> missed;  ///< [s] since when a key was somebody else's
  bool broken = false;                   ///< nothing can be shared here any more
  int waits = 0;                         ///< in a row, for one answer
  std::string waited_for;

  std::mutex mutex;
  std::condition_variable woken;
  bool ending = false;
  std::unique_ptr<tbb::global_control> limit;
  size_t limited_to = 0;
  std::thread settler;

  Impl(fs::path folder_, fs::path archive_, Options options_)
      : folder(std::move(folder_)),
        archive(std::move(archive_)),
        options(std::move(options_)),
        shared(folder_on_disk(folder, false)),
        tickets(shared),
        heartbeat(folder / "beats", options.times),
        leases(tickets, heartbeat.worker(), options.times, {}),
        watch(shared, options.times),
        settler([this] { settle(); }) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      ending = true;
    }
    woken.notify_all();
    settler.join();
  }

  Ticket ticket(const std::string& key) const { return {key, 0, heartbeat.worker()}; }

  /// Beside the work: who has gone is forgotten where it holds nothing, and threads are shared.
  void settle() {
    WorkerWatch watch(shared, options.times);
    std::unique_lock lock(mutex);
    while (!woken.wait_for(lock, std::chrono::duration<double>(kSettleEvery),
                           [&] { return ending; })) {
      const std::vector<std::string> workers = names_in(*shared, "beats");
      if (workers.size() < 2 && !limit) continue;
      std::set<std::string> holding, busy;
      for (const std::string& name : names_in(*shared, "leased")) {
        holding.insert(worker_of(name));
        if (!name.starts_with(kTaskMark)) busy.insert(worker_of(name));
      }
      for (const std::string& worker : workers)
        if (worker != heartbeat.worker() && !holding.contains(worker) && watch.gone(worker))
          watch.forget(worker);
      share_threads(busy);
    }
    limit.reset();
  }

  /// Whoever waits for others' answers lends its threads to those on its machine that work.
  void share_threads(const std::set<std::string>& busy) {
    const std::string& own = heartbeat.worker();
    const auto others = std::count_if(busy.begin(), busy.end(), [&](const std::string& worker) {
      return worker != own && host_of(worker) == host_of(own);
    });
    const size_t now = std::max<size_t>(
        1, static_cast<size_t>(options.threads) / (1 + static_cast<size_t>(others)));
    if (now == limited_to) return;
    limited_to = now;
    limit.reset();
    limit =
        std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, now);
  }

  /// Answered long ago, and the answer is not to be seen: its journal has gone.
  bool take_lost(const std::string& key) {
    const double now = shared->seconds();
    const double since = missed.try_emplace(key, now).first->second;
    if (now - since < kLostAfter) return false;
    missed[key] = now;
    for (const Ticket& one : tickets.at(TicketPlace::done))
      if (one.key == key)
        return tickets.move(one, TicketPlace::done, ticket(key), TicketPlace::leased);
    return false;
  }

  bool claim(const std::string& key) {
    tickets.enrol(key, json::object(), heartbeat.worker());
    return tickets.move({key, 0, ""}, TicketPlace::todo, ticket(key), TicketPlace::leased) ||
           take_lost(key);
  }

  /// The folder cannot be used, or was removed: this process goes on by itself.
  void alone(const std::exception& why) {
    if (!broken) spdlog::warn("the search goes on without its workers: {}", why.what());
    broken = true;
  }
};

SharedSearch::SharedSearch(fs::path folder, fs::path archive, Options options) {
  std::error_code failed;
  std::vector<std::string> folders = Tickets::folders();
  folders.emplace_back("answers");
  for (const std::string& name : folders) {
    if (!archive.empty()) break;  // whoever began the search made them
    fs::create_directories(folder / name, failed);
    if (failed) throw cannot_write(folder.string(), failed.message());
  }
  impl_ = std::make_unique<Impl>(std::move(folder), std::move(archive), std::move(options));
}

SharedSearch::~SharedSearch() {
  for (const std::string& key : std::set<std::string>(impl_->held)) finish(key, false);
}

/// One that was killed a moment ago has left its beat: what would be done ahead for it is in vain.
bool SharedSearch::others() {
  if (impl_->broken) return false;
  for (const std::string& name : names_in(*impl_->shared, "beats")) {
    if (name == worker()) continue;
    impl_->watch.gone(name);
    if (impl_->watch.known_alive(name)) return true;
  }
  return false;
}

const std::vector<std::unique_ptr<JournalReader>>& SharedSearch::journals() {
  const auto add = [&](const fs::path& file) {
    if (impl_->read.insert(file.string()).second)
      impl_->journals.push_back(std::make_unique<JournalReader>(file, impl_->options.made_for));
  };
  if (!impl_->archive.empty()) add(impl_->archive);
  for (const std::string& name : names_in(*impl_->shared, "answers"))
    if (name != worker()) add(impl_->folder / "answers" / name);
  for (const auto& journal : impl_->journals) journal->look();
  return impl_->journals;
}

bool SharedSearch::claim(const std::string& key) {
  if (impl_->broken) return true;
  if (impl_->waited_for != key) impl_->waits = 0;
  impl_->waited_for = key;
  try {
    if (!impl_->claim(key)) return false;
  } catch (const InputError& error) {  // no room, no hard links, no folder
    impl_->alone(error);
    return true;
  } catch (const fs::filesystem_error& error) {
    impl_->alone(error);
    return true;
  }
  impl_->held.insert(key);
  impl_->missed.erase(key);
  return true;
}

void SharedSearch::finish(const std::string& key, bool answered) {
  if (impl_->held.erase(key) == 0) return;
  try {
    if (answered)
      impl_->leases.finish(impl_->ticket(key), TicketPlace::done);
    else
      impl_->leases.give_back(impl_->ticket(key), 0);
  } catch (const std::exception& error) {
    impl_->alone(error);
  }
}

bool SharedSearch::answered(const std::string& key) {
  const std::vector<std::string> done = names_in(*impl_->shared, "done");
  return std::any_of(done.begin(), done.end(),
                     [&](const std::string& name) { return name.starts_with(key + "."); });
}

void SharedSearch::wait() {
  const int wait = std::min(kLongest, kShortest << std::min(impl_->waits++, 8));
  std::this_thread::sleep_for(std::chrono::milliseconds(wait));
  try {
    impl_->leases.look();
  } catch (const std::exception& error) {
    impl_->alone(error);
  }
}

std::string SharedSearch::worker() const { return impl_->heartbeat.worker(); }

fs::path SharedSearch::own_journal() const { return impl_->folder / "answers" / worker(); }

bool SharedSearch::at_work(const std::string& worker) const {
  return impl_->shared->exists("beats/" + worker);
}

void SharedSearch::tell(const SearchNotice& notice) const {
  json out = {{"master", notice.master},       {"made_for", notice.made_for},
              {"version", notice.version},     {"program", notice.program},
              {"processor", notice.processor}, {"without", notice.without},
              {"ended", notice.ended}};
  if (notice.from) out["from"] = *notice.from;
  write_text(impl_->folder / kNoticeFile, out.dump(1) + "\n");
}

std::optional<SearchNotice> notice_in(const fs::path& folder) {
  std::ifstream file(folder / kNoticeFile);
  const json told = json::parse(file, nullptr, false);
  if (!told.is_object()) return {};
  try {
    SearchNotice out{told.at("master"),  told.at("made_for"),  told.at("version"),
                     told.at("program"), told.at("processor"), {},
                     told.at("without"), told.at("ended")};
    if (told.contains("from")) out.from = told.at("from").get<int>();
    return out;
  } catch (const json::exception&) {
    return {};
  }
}

std::string processor_mark() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("flags") || line.starts_with("Features")) return fingerprint_of(line);
  return "unknown";
}

fs::path workers_folder(const fs::path& run) { return run / "workers"; }

void remove_workers_folder(const fs::path& folder) {
  const auto shared = folder_on_disk(folder, false);
  WorkerWatch watch(shared, {});
  constexpr int kTurns = 15;
  for (int turn = 0; turn < kTurns; ++turn) {
    const std::vector<std::string> there = names_in(*shared, "beats");
    if (std::all_of(there.begin(), there.end(),
                    [&](const std::string& worker) { return watch.gone(worker); })) {
      std::error_code ignored;
      fs::remove_all(folder, ignored);
      return;
    }
    if (std::any_of(there.begin(), there.end(),
                    [&](const std::string& worker) { return watch.known_alive(worker); }))
      return;  // it removes the folder when it leaves
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

}  // namespace hookeye
