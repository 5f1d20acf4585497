#include "runs/search_crew.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/fingerprint.h"
#include "core/json_file.h"
#include "core/text_file.h"
#include "runs/kept_work.h"
#include "sharing/leases.h"

namespace hookeye {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr const char* kSearchFile = "search.json";
constexpr double kPause = 0.03;  // [s] between two looks at what others do

std::string named(const std::string& mark) { return mark.substr(mark.find(':') + 1); }

}  // namespace

fs::path workers_folder(const fs::path& run) { return run / "workers"; }

std::optional<SearchAtWork> search_at_work(const fs::path& run) {
  const auto text = folder_on_disk(workers_folder(run))->read(kSearchFile);
  if (!text) return {};
  std::string damage;
  const auto told = parse_json(*text, damage);
  if (!told) return {};
  expect_shape(*told,
               {{"id", "text"},
                {"worker", "text"},
                {"made_for", "text"},
                {"from", "number"},
                {"without", json::array({"text"})}},
               workers_folder(run) / kSearchFile);
  return SearchAtWork{told->at("id"), told->at("worker"), told->at("made_for"), told->at("from"),
                      told->at("without")};
}

SearchCrew::SearchCrew(const fs::path& folder, Archive& archive)
    : folder_(folder),
      tickets_(folder_on_disk(folder)),
      heartbeat_(folder / "beats", BeatTimes{}),
      archive_(archive) {}

void SearchCrew::pause() const {
  std::this_thread::sleep_for(std::chrono::duration<double>(kPause));
}

std::string SearchCrew::batch_of(const std::vector<std::string>& keys) {
  std::string all;
  for (const std::string& key : keys) all += key + "\n";
  return "batches/" + named(fingerprint_of(all));
}

bool SearchCrew::all_done(const std::vector<std::string>& keys) const {
  std::set<std::string> left(keys.begin(), keys.end());
  for (const Ticket& ticket : tickets_.at(TicketPlace::done)) left.erase(ticket.key);
  return left.empty();
}

void SearchCrew::work_on(const std::vector<std::string>& keys,
                         const std::function<void(size_t)>& work, const std::function<bool()>& stop,
                         const std::function<double()>& patience) {
  Leases leases(tickets_, heartbeat_.worker(), BeatTimes{}, {keys, {}});
  double idle_since = shared().seconds();
  while (!stop() && !all_done(keys)) {
    leases.look();
    const std::optional<Ticket> ticket = leases.claim();
    if (!ticket) {
      if (shared().seconds() - idle_since > patience()) return;
      pause();
      continue;
    }
    const double began = shared().seconds();
    try {
      const auto at = std::find(keys.begin(), keys.end(), ticket->key);
      work(static_cast<size_t>(at - keys.begin()));
    } catch (...) {
      leases.give_back(*ticket, 0);
      throw;
    }
    idle_since = shared().seconds();
    if (stop()) {  // the work was cut short
      leases.give_back(*ticket, 0);
      return;
    }
    archive_.sync();
    leases.finish(*ticket, TicketPlace::done);
    tally_.seconds += idle_since - began;
    tally_.longest = std::max(tally_.longest, idle_since - began);
    ++tally_.tasks;
  }
}

/// The search's own process.
class SharedSearch::Own final : public SearchCrew {
 public:
  Own(const fs::path& folder, Archive& archive, std::string made_for,
      const std::atomic<bool>* cancel)
      : SearchCrew(folder, archive),
        made_for_(std::move(made_for)),
        cancel_(cancel),
        watch_(tickets_.shared(), BeatTimes{}) {
    learn();
  }
  const std::string& worker() const { return heartbeat_.worker(); }
  bool wait() override { return false; }

  void share(const std::vector<std::string>& keys,
             const std::function<void(size_t)>& work) override {
    if (!fs::exists(folder_)) return;  // somebody has removed it
    const bool alone = !others_there();
    if (!alone)
      for (const std::string& key : keys) tickets_.enrol(key, json::object(), worker());
    shared().write(batch_of(keys), alone ? "alone\n" : "shared\n");
    if (alone) return;
    spdlog::debug("{} tasks are shared out", keys.size());
    // A worker that was stopped or is lost behind a network is waited for, but not for ever: what
    // it has in hand is then worked out here.
    constexpr double kLeast = 60.0, kTimes = 3.0;
    work_on(
        keys, work, [&] { return cancel_ && cancel_->load(); },
        [&] { return std::max(kLeast, kTimes * tally().longest); });
    learn();
  }

  bool others_there() {
    for (const std::string& name : shared().names("beats"))
      if (name != worker() && !watch_.gone(name)) return true;
    return false;
  }
  /// What workers have worked out, now or for a search that was stopped.
  void learn() {
    for (const std::string& name : shared().names("answers")) {
      auto [place, is_new] = answers_.try_emplace(name);
      if (is_new)
        place->second =
            std::make_shared<Journal>(Journal::of_another(folder_ / "answers" / name, made_for_));
      archive_.learn_from(place->second, true);
    }
  }

 private:
  const std::string made_for_;
  const std::atomic<bool>* cancel_;
  WorkerWatch watch_;
  std::map<std::string, std::shared_ptr<Journal>> answers_;
};

SharedSearch::SharedSearch(const Run& run, Bench& bench, int from,
                           const std::vector<std::string>& without, const std::atomic<bool>* cancel)
    : folder_(workers_folder(run.folder())), archive_(bench.workspace.archive()), cancel_(cancel) {
  if (!archive_) return;
  const std::string made_for = archive_made_for(run), mark = fingerprint_of(made_for);
  std::error_code ignored;
  if (const auto before = search_at_work(run.folder()); before && before->made_for != mark)
    fs::remove_all(folder_, ignored);  // another program's, or another capture's
  for (const std::string& name : Tickets::folders()) fs::create_directories(folder_ / name);
  for (const char* name : {"batches", "answers"}) fs::create_directories(folder_ / name);
  crew_ = std::make_shared<Own>(folder_, *archive_, made_for, cancel);
  archive_->work_with(crew_);
  write_text(folder_ / kSearchFile, json{{"id", crew_->worker() + fmt::format("/{}", from)},
                                         {"worker", crew_->worker()},
                                         {"made_for", mark},
                                         {"from", from},
                                         {"without", without}}
                                            .dump() +
                                        "\n");
}

SharedSearch::~SharedSearch() {
  if (!crew_) return;
  archive_->work_with(nullptr);
  const bool stopped = cancel_ && cancel_->load() && crew_->others_there();
  if (crew_->tally().tasks > 0)
    spdlog::debug("of the tasks that were shared out {} were worked out here",
                  crew_->tally().tasks);
  std::error_code ignored;
  if (!stopped) fs::remove(folder_ / kSearchFile, ignored);
  constexpr int kTurns = 100;  // in which workers see that, and leave
  for (int i = 0; i < kTurns && !stopped && fs::exists(folder_) && crew_->others_there(); ++i)
    std::this_thread::sleep_for(std::chrono::duration<double>(kPause));
  crew_.reset();
  if (!stopped) fs::remove_all(folder_, ignored);
}

}  // namespace hookeye
