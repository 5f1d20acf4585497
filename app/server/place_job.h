// `hookeye place` of a capture that is being edited, in the background.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "app/server/own_program.h"
#include "capture_io/placement.h"

namespace hookeye {

/// One at a time. Thread-safe.
class PlaceJob {
 public:
  /// Takes the place that was found, from the job's thread; what it throws is told.
  using Found = std::function<void(const ToldPlacement& place)>;

  PlaceJob() = default;
  PlaceJob(const PlaceJob&) = delete;
  PlaceJob& operator=(const PlaceJob&) = delete;
  ~PlaceJob();
  /// `pairs` as --pair has them; none: by the outline. False: one runs already.
  bool start(const std::filesystem::path& file, const std::vector<std::string>& pairs, Found found);
  void stop();
  /// {state: "idle" | "running" | "done" | "failed" | "stopped", message}
  nlohmann::json state();

 private:
  void work(std::vector<std::string> arguments, const Found& found);
  void finish(const std::string& state, const std::string& message);
  std::mutex mutex_;
  nlohmann::json state_{{"state", "idle"}, {"message", ""}};
  bool running_ = false, stopped_ = false;
  OwnProgram program_;
  std::thread thread_;
};

}  // namespace hookeye
