#include "batch/batch_worker.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <ctime>
#include <deque>
#include <map>

#include "batch/child.h"
#include "batch/finding.h"
#include "batch/obstacles.h"
#include "core/input_error.h"
#include "core/interrupted.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Clock = std::chrono::steady_clock;
constexpr double kGrace = 20.0;     // [s] from the request to stop until a process is killed
constexpr double kLookEvery = 1.0;  // [s] how often the folder is looked through

/// "2026-11-29T21:30:05Z": for people alone.
std::string time_text() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  char text[32] = "";
  std::strftime(text, sizeof text, "%FT%TZ", &parts);
  return text;
}

/// A capture in the hands of this worker.
struct InHand {
  Ticket ticket;
  BatchTask task;
  Child child;
  bool reporting = false;  ///< the run is done, its page is being written
  json result = json::object();
  bool timed_out = false;
  double stopping_since = -1.0;  ///< [s] of the child's life; below 0: it is not to stop
};

class BatchWorker {
 public:
  BatchWorker(const BatchFolder& folder, const WorkOptions& options)
      : folder_(folder),
        options_(options),
        heartbeat_(folder.beats(), options.times),
        watch_(folder.beats(), options.times),
        program_(mark_of(options.program)),
        wanted_(options.keys.begin(), options.keys.end()) {}

  BatchWorker(const BatchWorker&) = delete;
  BatchWorker& operator=(const BatchWorker&) = delete;
  /// What it leaves behind where something was thrown is free again.
  ~BatchWorker() {
    for (InHand& one : in_hand_) {
      one.child.kill();
      try {
        give_back(one.ticket, 0);
      } catch (const std::exception&) {  // it is taken up when this worker is seen to be gone
      }
    }
  }

  void run() {
    while (true) {
      settle_ended();
      look_after_running();
      if (stopping() && in_hand_.empty()) throw Interrupted{};
      if (!closed_.empty() && in_hand_.empty())
        throw InputError({folder_.path().string()}, closed_, closed_remedy_);
      if (!stopping()) fill();
      if (in_hand_.empty() && closed_.empty() && !stopping() && nothing_left()) return;
      tell_progress();
      wait();
    }
  }

 private:
  bool stopping() const { return options_.cancel && options_.cancel->load(); }
  bool is_wanted(const std::string& key) const { return wanted_.empty() || wanted_.count(key); }

  /// No more is begun, and why.
  void close(std::string why, std::string remedy) {
    if (closed_.empty()) closed_ = std::move(why), closed_remedy_ = std::move(remedy);
  }
  void close_if_it_must() {
    if (mark_of(options_.program) != program_)
      close(fmt::format("the program {} was replaced while the batch ran; captures are left",
                        options_.program.string()),
            "the rest by the same program, or all by the new one in a new folder");
    if (out_of_room(folder_.path())) close_for_room();
  }
  void close_for_room() {
    close("the disk is full; captures are left", "make room, then give the same command again");
  }

  /// Starts what there is room for.
  void fill() {
    while (in_hand_.size() < static_cast<size_t>(options_.jobs)) {
      if (waiting_.empty()) look();
      if (waiting_.empty()) return;
      close_if_it_must();
      if (!closed_.empty()) return;
      const std::optional<Ticket> ticket = claim();
      if (!ticket) return;
      begin(*ticket);
    }
  }

  std::optional<Ticket> claim() {
    while (!waiting_.empty()) {
      const Ticket ticket = waiting_.front();
      waiting_.pop_front();
      const Ticket own{ticket.key, ticket.tries, heartbeat_.worker()};
      if (folder_.move(ticket, TicketPlace::todo, own, TicketPlace::leased)) return own;
    }
    return {};
  }

  /// What lies in todo, at most once a second; and leases of those who are gone.
  void look() {
    const auto now = Clock::now();
    if (looked_ != Clock::time_point() &&
        std::chrono::duration<double>(now - looked_).count() < kLookEvery)
      return;
    looked_ = now;
    folder_.finish_enrolling([&](const std::string& worker) { return watch_.gone(worker); });
    take_up_abandoned();
    const std::set<std::string> past = folder_.past();
    for (const Ticket& ticket : folder_.tickets(TicketPlace::todo))
      if (is_wanted(ticket.key) && !past.count(ticket.key)) waiting_.push_back(ticket);
    put_in_order();
  }

  /// As the list has them. Where there is none, everybody begins elsewhere, so that many workers
  /// do not ask for the same one.
  void put_in_order() {
    if (waiting_.empty()) return;
    std::map<std::string, size_t> place;
    for (const std::string& key : options_.keys) place.emplace(key, place.size());
    std::sort(waiting_.begin(), waiting_.end(), [&](const Ticket& a, const Ticket& b) {
      return std::tie(place[a.key], a.key) < std::tie(place[b.key], b.key);
    });
    if (!options_.keys.empty()) return;
    const size_t first = std::hash<std::string>()(heartbeat_.worker()) % waiting_.size();
    std::rotate(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(first),
                waiting_.end());
  }

  /// A lease is taken over by one rename: of those who see that its worker is gone one gets it.
  void take_up_abandoned() {
    std::set<std::string> gone;
    in_doubt_ = 0;
    for (const Ticket& ticket : folder_.tickets(TicketPlace::leased)) {
      if (ticket.worker == heartbeat_.worker()) continue;
      if (!gone.count(ticket.worker) && !watch_.gone(ticket.worker)) {
        in_doubt_ += !watch_.known_alive(ticket.worker);
        continue;
      }
      gone.insert(ticket.worker);
      folder_.move(ticket, TicketPlace::leased, {ticket.key, ticket.tries, ""}, TicketPlace::todo);
    }
    for (const std::string& worker : gone) watch_.forget(worker);
  }

  std::vector<std::string> arguments_of(const BatchTask& task) const {
    const BatchOrder& order = folder_.order();
    std::vector<std::string> out = {order.verb, task.capture.string(), "-o",
                                    folder_.run_of(task).string()};
    out.insert(out.end(), order.options.begin(), order.options.end());
    out.insert(out.end(), task.options.begin(), task.options.end());
    out.insert(out.end(), {"--json", "--threads", std::to_string(options_.threads)});
    return out;
  }

  void begin(const Ticket& ticket) {
    BatchTask task = folder_.task(ticket.key);
    json result = {{"began", time_text()}, {"worker", heartbeat_.worker()}};
    if (content_of(task.capture) != task.content) {
      result["exit"] = 2;
      result["error"] = fmt::format(
          "{}: this capture has changed since it was listed (the same command lists it anew)",
          task.capture.string());
      finish(ticket, task, std::move(result));
      return;
    }
    try {
      Child child(options_.program, arguments_of(task), folder_.log_of(task, ".json"),
                  folder_.log_of(task, ".txt"), options_.memory);
      in_hand_.push_back({ticket, std::move(task), std::move(child), false, std::move(result)});
    } catch (...) {
      give_back(ticket, 0);
      throw;
    }
  }

  /// For whoever comes next. `tries`: how many more of its processes were killed.
  void give_back(const Ticket& ticket, int tries) {
    folder_.move(ticket, TicketPlace::leased, {ticket.key, ticket.tries + tries, ""},
                 TicketPlace::todo);
    looked_ = {};
  }

  void settle_ended() {
    for (size_t i = 0; i < in_hand_.size();) {
      const std::optional<ChildEnd> end = in_hand_[i].child.ended();
      if (!end) {
        ++i;
        continue;
      }
      InHand ended = std::move(in_hand_[i]);
      in_hand_.erase(in_hand_.begin() + static_cast<std::ptrdiff_t>(i));
      settle(std::move(ended), *end);
    }
  }

  void settle(InHand ended, const ChildEnd& end) {
    json& result = ended.result;
    result["seconds"] = result.value("seconds", 0.0) + end.seconds;
    result["cpu_seconds"] = result.value("cpu_seconds", 0.0) + end.cpu;
    result["memory"] = std::max(result.value("memory", 0.0), end.memory);
    if (ended.reporting) {
      settle_report(std::move(ended), end);
      return;
    }
    constexpr int kStopped = 130;
    const bool stopped = end.signal != 0 || end.status == kStopped;
    if (stopped && stopping()) {
      give_back(ended.ticket, 0);
      return;
    }
    result["exit"] = end.status;
    if (end.status != 0)
      result["error"] =
          error_line(folder_.log_of(ended.task, ".json"), folder_.log_of(ended.task, ".txt"));
    if (ended.timed_out && end.status != 0) {
      result["error"] = fmt::format("it took longer than {:g} s (--timeout)", options_.timeout);
    } else if (stopped) {
      settle_killed(std::move(ended), end);
      return;
    } else if (end.status != 0 && tells_a_full_disk(result["error"])) {
      give_back(ended.ticket, 0);
      close_for_room();
      return;
    }
    if (end.status == 0 && !add_finding(ended)) return;
    finish(ended.ticket, ended.task, std::move(result));
  }

  /// By somebody, or by a system that has no memory left: it is begun again, a few times.
  void settle_killed(InHand ended, const ChildEnd& end) {
    if (ended.ticket.tries + 1 < kMostTries) {
      warn(fmt::format("{}: its process was killed (signal {}), it is begun again",
                       ended.task.label, end.signal ? end.signal : SIGTERM));
      give_back(ended.ticket, 1);
      return;
    }
    ended.result["error"] = fmt::format(
        "its process was killed {} times, last by signal {} (memory may be out: fewer --jobs)",
        kMostTries, end.signal ? end.signal : SIGTERM);
    finish(ended.ticket, ended.task, std::move(ended.result));
  }

  /// False: the run's page is being written first.
  bool add_finding(InHand& ended) {
    if (!makes_run(folder_.order().verb)) {
      ended.result["finding"] = finding_of_log(folder_.log_of(ended.task, ".txt"));
      return true;
    }
    const fs::path run = folder_.run_of(ended.task);
    try {
      ended.result["finding"] = finding_of_run(run);
    } catch (const InputError& error) {
      ended.result["exit"] = 1;
      ended.result["error"] = error.wrong();
      return true;
    }
    if (!folder_.order().reports || stopping()) return true;
    const std::vector<std::string> words = {"report",    run.string(),
                                            "-o",        folder_.report_of(ended.task).string(),
                                            "--threads", std::to_string(options_.threads)};
    Child child(options_.program, words, "/dev/null", folder_.log_of(ended.task, ".report.txt"),
                options_.memory);
    in_hand_.push_back({ended.ticket, ended.task, std::move(child), true, std::move(ended.result)});
    return false;
  }

  /// A run stands without its page, too.
  void settle_report(InHand ended, const ChildEnd& end) {
    if (end.status != 0 && !stopping())
      warn(fmt::format("{}: no page of its run: {}", ended.task.label,
                       error_line("", folder_.log_of(ended.task, ".report.txt"))));
    finish(ended.ticket, ended.task, std::move(ended.result));
  }

  void finish(const Ticket& ticket, const BatchTask& task, json result) {
    result["ended"] = time_text();
    const bool good = result.at("exit") == 0;
    if (!good)
      warn(fmt::format("{}: exit status {}: {}", task.label, result["exit"].get<int>(),
                       result.value("error", "")));
    if (!folder_.is_at(ticket, TicketPlace::leased)) return;  // it is another's
    folder_.store_result(ticket, result);
    folder_.move(ticket, TicketPlace::leased, ticket,
                 good ? TicketPlace::done : TicketPlace::failed);
    looked_ = {};
  }

  /// Those that are to stop, that take too long, or that somebody else has taken over.
  void look_after_running() {
    const auto now = Clock::now();
    const bool check_leases = std::chrono::duration<double>(now - checked_).count() >= kLookEvery;
    if (check_leases) checked_ = now;
    for (size_t i = 0; i < in_hand_.size();) {
      InHand& one = in_hand_[i];
      if (check_leases && !folder_.is_at(one.ticket, TicketPlace::leased)) {
        warn(fmt::format("{}: this worker was out of sight, and another has taken the capture up",
                         one.task.label));
        in_hand_.erase(in_hand_.begin() + static_cast<std::ptrdiff_t>(i));  // and kills the child
        continue;
      }
      const double lived = one.child.seconds();
      if (!one.reporting && options_.timeout > 0.0 && lived > options_.timeout)
        one.timed_out = true;
      if (one.stopping_since < 0.0 && (stopping() || one.timed_out)) {
        one.stopping_since = lived;
        one.child.stop();
      }
      if (one.stopping_since >= 0.0 && lived > one.stopping_since + kGrace) one.child.kill();
      ++i;
    }
  }

  /// By what has ended, not by what cannot be seen to be left: a ticket that is given back while
  /// the folders are read may show in none of them.
  bool nothing_left() {
    if (!waiting_.empty()) return false;
    const BatchCounts now = count(folder_, options_.keys);
    if (!options_.wait_for_others) return now.todo == 0 && in_doubt_ == 0;
    return now.done + now.failed >= expected();
  }
  int expected() const {
    const std::vector<std::string> keys = options_.keys.empty() ? folder_.keys() : options_.keys;
    const std::set<std::string> past = folder_.past();
    return static_cast<int>(std::count_if(
        keys.begin(), keys.end(), [&](const std::string& key) { return !past.count(key); }));
  }

  void tell_progress() {
    const auto now = Clock::now();
    if (!options_.progress || std::chrono::duration<double>(now - told_).count() < kLookEvery)
      return;
    told_ = now;
    options_.progress(count(folder_, options_.keys));
  }
  void warn(const std::string& sentence) const {
    if (options_.warn) options_.warn(sentence);
  }

  /// Until a process ends, but not for long.
  void wait() {
    constexpr int kLong = 200, kShort = 20;  // [ms]
    int most = kLong;
    std::vector<pollfd> ends;
    bool all_known = true;
    for (const InHand& one : in_hand_) {
      all_known = all_known && one.child.handle() >= 0;
      ends.push_back({one.child.handle(), POLLIN, 0});
      const double left = options_.timeout - one.child.seconds();
      if (options_.timeout > 0.0 && left < 1e-3 * most)
        most = one.timed_out ? most : std::max(1, static_cast<int>(1e3 * left));
    }
    ::poll(ends.data(), ends.size(), all_known ? most : std::min(most, kShort));
    if (waiting_.empty() && !in_hand_.empty()) look();
  }

  const BatchFolder& folder_;
  const WorkOptions& options_;
  Heartbeat heartbeat_;
  WorkerWatch watch_;
  FileMark program_;
  std::set<std::string> wanted_;
  std::vector<InHand> in_hand_;
  std::deque<Ticket> waiting_;
  int in_doubt_ = 0;  ///< leases of workers of whom it is not known whether they are gone
  Clock::time_point looked_, checked_, told_;
  std::string closed_, closed_remedy_;
};

}  // namespace

void work_on(const BatchFolder& folder, const WorkOptions& options) {
  BatchWorker(folder, options).run();
}

}  // namespace hookeye
