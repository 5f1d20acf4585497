// One refit at a time, in the background: it goes on when the page is closed, and can be stopped.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "app/commands/run_support.h"
#include "runs/add_step.h"

namespace hookeye {

class RefitJob {
 public:
  explicit RefitJob(std::filesystem::path run) : run_(std::move(run)) {}
  ~RefitJob();

  /// False: another one is running.
  bool start(const AddRequest& request);
  void stop() { cancel_ = true; }
  /// {state: idle | running | stopping | done | failed | stopped, effect, take_back, stage,
  ///  iteration, of, chi, seconds, share, seconds_left, message}; `share` of the whole work, and
  ///  the seconds that the rest would take at its pace.
  nlohmann::json state();

 private:
  using Clock = std::chrono::steady_clock;
  void work(const AddRequest& request);
  void refit(const AddRequest& request);
  void told(const FitProgress& progress);
  void told_diagnosis(int done, int of);
  void reach(double share);  ///< mutex_ is held
  void stage(const std::string& name);
  void begin_stage(const std::string& name);  ///< mutex_ is held
  void finish(const std::string& state, const std::string& message);
  AddOptions options();

  std::filesystem::path run_;
  std::atomic<bool> cancel_{false};
  std::thread thread_;
  std::mutex mutex_;  ///< of what follows
  bool running_ = false;
  nlohmann::json state_ = {{"state", "idle"}};
  Clock::time_point started_;
  double share_ = 0.0;            ///< of the work that is done; never falls
  double from_ = 0.0, to_ = 0.0;  ///< what the present stage is of it
  // Used by the thread alone: the capture stays open between refits.
  Session session_;
  std::optional<Bench> bench_;
};

}  // namespace hookeye
