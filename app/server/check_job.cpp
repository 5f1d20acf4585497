#include "app/server/check_job.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <utility>

#include "core/own_file.h"

namespace hookeye {

using nlohmann::json;

namespace {

/// Somebody who types or drags changes a file many times; only the last counts.
constexpr auto kPause = std::chrono::milliseconds(700);

/// `hookeye check --json FILE` with its document in a pipe; -1: it cannot be started.
pid_t spawn_check(const std::filesystem::path& file, int out) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out, 1);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t all, none;  // our threads have Ctrl-C blocked
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  std::string program = own_file().string(), name = file.string();
  std::string verb = "check", option = "--json";
  char* const arguments[] = {program.data(), verb.data(), option.data(), name.data(), nullptr};
  pid_t child = -1;
  if (posix_spawn(&child, program.c_str(), &actions, &attributes, arguments, environ) != 0)
    child = -1;
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return child;
}

std::string read_all(int from) {
  std::string text;
  char part[65536];
  for (;;) {
    const ssize_t n = ::read(from, part, sizeof part);
    if (n > 0) text.append(part, static_cast<size_t>(n));
    if (n == 0 || (n < 0 && errno != EINTR)) return text;
  }
}

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
    if (child_ > 0) ::kill(child_, SIGKILL);
  }
  changed_.notify_all();
  thread_.join();
}

void CheckJob::start(const std::string& mark) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = mark;
    state_ = {{"state", "running"}, {"mark", mark}};
    if (child_ > 0) ::kill(child_, SIGKILL);
  }
  changed_.notify_all();
}

json CheckJob::state() {
  const std::lock_guard lock(mutex_);
  return state_;
}

json CheckJob::checked() {
  int ends[2];
  const json cannot{{"state", "failed"}, {"message", "`hookeye check` cannot be started"}};
  if (::pipe2(ends, O_CLOEXEC) != 0) return cannot;
  {
    const std::lock_guard lock(mutex_);
    if (!ended_ && wanted_.empty()) child_ = spawn_check(file_, ends[1]);
  }
  ::close(ends[1]);
  const std::string text = read_all(ends[0]);
  ::close(ends[0]);
  const std::lock_guard lock(mutex_);
  if (child_ <= 0) return cannot;
  ::waitpid(child_, nullptr, 0);  // its end of the pipe is closed: it has ended
  child_ = -1;
  return told_of(json::parse(text, nullptr, false));
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
    json done = checked();
    done["mark"] = mark;
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    if (wanted_.empty()) state_ = std::move(done);
  }
}

}  // namespace hookeye
