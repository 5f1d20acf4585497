#include "app/server/own_program.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "core/own_file.h"

namespace hookeye {
namespace {

/// With its document in a pipe; -1: it cannot be started.
pid_t spawn(std::vector<std::string> arguments, int out) {
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
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  pid_t child = -1;
  if (posix_spawn(&child, words.front(), &actions, &attributes, words.data(), environ) != 0)
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

}  // namespace

nlohmann::json OwnProgram::run(std::vector<std::string> arguments,
                               const std::function<bool()>& wanted) {
  int ends[2];
  try {
    arguments.insert(arguments.begin(), own_file().string());
  } catch (const std::runtime_error&) {
    return nullptr;
  }
  if (::pipe2(ends, O_CLOEXEC) != 0) return nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (wanted()) child_ = spawn(std::move(arguments), ends[1]);
  }
  ::close(ends[1]);
  const std::string text = read_all(ends[0]);
  ::close(ends[0]);
  const std::lock_guard lock(mutex_);
  if (child_ <= 0) return nullptr;
  ::waitpid(child_, nullptr, 0);  // its end of the pipe is closed: it has ended
  child_ = -1;
  const auto document = nlohmann::json::parse(text, nullptr, false);
  return document.is_object() ? document : nullptr;
}

void OwnProgram::kill() {
  const std::lock_guard lock(mutex_);
  if (child_ > 0) ::kill(child_, SIGKILL);
}

}  // namespace hookeye
