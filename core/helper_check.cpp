#include "core/helper_check.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <exception>
#include <filesystem>
#include <string>

#include "core/helper.h"

namespace hookeye {
namespace {

constexpr int kMostMilliseconds = 60'000;  // gmsh loads 200 libraries, on a busy machine too

std::filesystem::path program_of(const std::string& name) {
  try {
    return helper_folder() / name;
  } catch (const std::exception&) {  // there is no such folder
    return {};
  }
}

/// Starts the program with nothing open but standard error, which goes into `to`. -1: not started.
pid_t start(const std::string& program, int to) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, to, 2);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&files, 3);
  std::string argument = program;
  char* arguments[] = {argument.data(), nullptr};
  pid_t process = -1;
  if (::posix_spawn(&process, program.c_str(), &files, nullptr, arguments, environ) != 0)
    process = -1;
  posix_spawn_file_actions_destroy(&files);
  return process;
}

/// What it says until it ends. One that does not end is killed.
std::string said_until_the_end(int from, pid_t process) {
  std::string said;
  char some[4096];
  pollfd one{from, POLLIN, 0};
  while (::poll(&one, 1, kMostMilliseconds) > 0) {
    const ssize_t count = ::read(from, some, sizeof some);
    if (count <= 0) return said;
    said.append(some, static_cast<size_t>(count));
  }
  ::kill(process, SIGKILL);
  return said;
}

/// "libgmsh.so.4.8" of "...: error while loading shared libraries: libgmsh.so.4.8: cannot open ..."
std::string missing_library(const std::string& said) {
  const std::string before = "loading shared libraries: ";
  const size_t at = said.find(before);
  if (at == std::string::npos) return {};
  const size_t begin = at + before.size();
  return said.substr(begin, said.find_first_of(": \n", begin) - begin);
}

}  // namespace

HelperCheck check_helper(const std::string& name) {
  HelperCheck out;
  const std::filesystem::path program = program_of(name);
  std::error_code failed;
  out.there = !program.empty() && std::filesystem::exists(program, failed);
  int ends[2] = {-1, -1};
  if (!out.there || ::pipe2(ends, O_CLOEXEC) != 0) return out;
  const auto begin = std::chrono::steady_clock::now();
  const pid_t process = start(program.string(), ends[1]);
  ::close(ends[1]);
  if (process > 0) {
    out.missing = missing_library(said_until_the_end(ends[0], process));
    int status = -1;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    out.loads = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  ::close(ends[0]);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace hookeye
