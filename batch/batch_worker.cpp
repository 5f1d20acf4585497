#include "batch/batch_worker.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "batch/capture_process.h"
#include "batch/obstacles.h"
#include "core/input_error.h"
#include "core/interrupted.h"

namespace hookeye {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;
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

class BatchWorker {
 public:
  BatchWorker(const BatchFolder& folder, const WorkOptions& options)
      : folder_(folder),
        options_(options),
        heartbeat_(folder.beats(), options.times),
        leases_(folder.tickets(), heartbeat_.worker(), options.times,
                {options.keys, [&folder] { return folder.past(); }}),
        program_(mark_of(options.program)) {}

  BatchWorker(const BatchWorker&) = delete;
  BatchWorker& operator=(const BatchWorker&) = delete;
  /// What it leaves behind where something was thrown is free again.
  ~BatchWorker() {
    for (const CaptureProcess& one : in_hand_) {
      one.kill();
      try {
        leases_.give_back(one.ticket(), 0);
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
      if (leases_.none_waits()) leases_.look();
      if (leases_.none_waits()) return;
      close_if_it_must();
      if (!closed_.empty()) return;
      const std::optional<Ticket> ticket = leases_.claim();
      if (!ticket) return;
      begin(*ticket);
    }
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
      in_hand_.emplace_back(folder_, options_, ticket, std::move(task), std::move(result));
    } catch (...) {
      leases_.give_back(ticket, 0);
      throw;
    }
  }

  void settle_ended() {
    for (size_t i = 0; i < in_hand_.size();) {
      const CaptureState state = in_hand_[i].settle(stopping());
      if (state == CaptureState::running) {
        ++i;
        continue;
      }
      CaptureProcess ended = std::move(in_hand_[i]);
      in_hand_.erase(in_hand_.begin() + static_cast<std::ptrdiff_t>(i));
      if (state == CaptureState::finished)
        finish(ended.ticket(), ended.task(), std::move(ended.result()));
      else if (state == CaptureState::killed)
        settle_killed(std::move(ended));
      else
        leases_.give_back(ended.ticket(), 0);
      if (state == CaptureState::no_room) close_for_room();
    }
  }

  /// It is begun again, a few times.
  void settle_killed(CaptureProcess ended) {
    if (ended.ticket().tries + 1 < kMostTries) {
      warn(fmt::format("{}: its process was killed (signal {}), it is begun again",
                       ended.task().label, ended.signal()));
      leases_.give_back(ended.ticket(), 1);
      return;
    }
    ended.result()["error"] = fmt::format(
        "its process was killed {} times, last by signal {} (memory may be out: fewer --jobs)",
        kMostTries, ended.signal());
    finish(ended.ticket(), ended.task(), std::move(ended.result()));
  }

  void finish(const Ticket& ticket, const BatchTask& task, json result) {
    result["ended"] = time_text();
    const bool good = result.at("exit") == 0;
    if (!good)
      warn(fmt::format("{}: exit status {}: {}", task.label, result["exit"].get<int>(),
                       result.value("error", "")));
    if (!leases_.has(ticket)) return;  // it is another's
    folder_.store_result(ticket, result);
    leases_.finish(ticket, good ? TicketPlace::done : TicketPlace::failed);
    counted_ = {};
  }

  /// Those that are to stop, that take too long, or that somebody else has taken over.
  void look_after_running() {
    const auto now = Clock::now();
    const bool check_leases = std::chrono::duration<double>(now - checked_).count() >= kLookEvery;
    if (check_leases) checked_ = now;
    for (size_t i = 0; i < in_hand_.size();) {
      CaptureProcess& one = in_hand_[i];
      if (check_leases && !leases_.has(one.ticket())) {
        warn(fmt::format("{}: this worker was out of sight, and another has taken the capture up",
                         one.task().label));
        in_hand_.erase(in_hand_.begin() + static_cast<std::ptrdiff_t>(i));  // and kills the child
        continue;
      }
      one.look_after(stopping());
      ++i;
    }
  }

  /// By what has ended, not by what cannot be seen to be left: a ticket that is given back while
  /// the folders are read may show in none of them.
  /// Of thousands of tickets that is a long list: it is asked for once a second, and where
  /// something has ended here.
  bool nothing_left() {
    if (!leases_.none_waits()) return false;
    const auto now_is = Clock::now();
    if (std::chrono::duration<double>(now_is - counted_).count() < kLookEvery) return false;
    counted_ = now_is;
    const BatchCounts now = count(folder_, options_.keys);
    if (!options_.wait_for_others) return now.todo == 0 && leases_.in_doubt() == 0;
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
    for (const CaptureProcess& one : in_hand_) {
      all_known = all_known && one.child().handle() >= 0;
      ends.push_back({one.child().handle(), POLLIN, 0});
      const double left = options_.timeout - one.child().seconds();
      if (options_.timeout > 0.0 && left < 1e-3 * most)
        most = one.timed_out() ? most : std::max(1, static_cast<int>(1e3 * left));
    }
    ::poll(ends.data(), ends.size(), all_known ? most : std::min(most, kShort));
    if (leases_.none_waits() && !in_hand_.empty()) leases_.look();
  }

  const BatchFolder& folder_;
  const WorkOptions& options_;
  Heartbeat heartbeat_;
  Leases leases_;
  FileMark program_;
  std::vector<CaptureProcess> in_hand_;
  Clock::time_point checked_, counted_, told_;
  std::string closed_, closed_remedy_;
};

}  // namespace

void work_on(const BatchFolder& folder, const WorkOptions& options) {
  BatchWorker(folder, options).run();
}

}  // namespace hookeye
