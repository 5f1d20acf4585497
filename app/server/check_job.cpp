#include "app/server/check_job.h"

#include <chrono>
#include <utility>

namespace hookeye {

using nlohmann::json;

namespace {

/// Somebody who types or drags changes a file many times; only the last counts.
constexpr auto kPause = std::chrono::milliseconds(700);

/// What the page shows of a check's document.
json told_of(const json& document) {
  if (!document.is_object())
    return {{"state", "failed"}, {"message", "`hookeye check` ended without an answer"}};
  json out{{"state", "done"}};
  if (document.contains("error")) out["error"] = document["error"];
  out["warnings"] = document.value("warnings", json::array());
  const json inspection = document.value("inspection", json::object());
  out["inspected"] = inspection.value("warnings", json::array());
  out["cameras"] = inspection.value("cameras", json::array());
  out["first_guess"] = inspection.value("first_guess", json::array());
  return out;
}

}  // namespace

CheckJob::CheckJob(std::filesystem::path file)
    : file_(std::move(file)), thread_([this] { work(); }) {}

CheckJob::~CheckJob() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  program_.kill();
  changed_.notify_all();
  thread_.join();
}

void CheckJob::start(const std::string& mark) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = mark;
    state_ = {{"state", "running"}, {"mark", mark}};
  }
  program_.kill();
  changed_.notify_all();
}

json CheckJob::state() {
  const std::lock_guard lock(mutex_);
  return state_;
}

void CheckJob::work() {
  for (;;) {
    std::string mark;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return ended_ || !wanted_.empty(); });
      mark = wanted_;
      if (!ended_ && changed_.wait_for(lock, kPause, [&] { return ended_ || wanted_ != mark; }))
        continue;
      if (ended_) return;
      wanted_.clear();
    }
    json done = told_of(program_.run({"check", "--json", file_.string()}, [this] {
      const std::lock_guard lock(mutex_);
      return !ended_ && wanted_.empty();
    }));
    done["mark"] = mark;
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    if (wanted_.empty()) state_ = std::move(done);
  }
}

}  // namespace hookeye
