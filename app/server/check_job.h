// `hookeye check` of a file that is being edited, in the background.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "app/server/own_program.h"

namespace hookeye {

/// One at a time: a change ends the one before. Thread-safe.
class CheckJob {
 public:
  explicit CheckJob(std::filesystem::path file);
  CheckJob(const CheckJob&) = delete;
  CheckJob& operator=(const CheckJob&) = delete;
  ~CheckJob();  ///< ends what runs
  /// Soon; `mark` names the text that is looked at.
  void start(const std::string& mark);
  /// {state: "idle" | "running" | "done" | "failed", mark, and once it is done: warnings, cameras,
  /// first_guess, inspected (warnings with their places), error}.
  nlohmann::json state();

 private:
  void work();
  std::filesystem::path file_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string wanted_;  ///< mark; empty: nothing is
  nlohmann::json state_{{"state", "idle"}};
  OwnProgram program_;
  bool ended_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace hookeye
