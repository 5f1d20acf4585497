#include "batch/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/input_error.h"

namespace hookeye {
namespace {

/// posix_spawn's two lists, which are freed.
struct SpawnPlan {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;

  SpawnPlan(const std::string& out, const std::string& err) {
    posix_spawn_file_actions_init(&files);
    const int writes = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, 1, out.c_str(), writes, 0644);
    posix_spawn_file_actions_addopen(&files, 2, err.c_str(), writes, 0644);
    posix_spawn_file_actions_addclosefrom_np(&files, 3);
    posix_spawnattr_init(&attributes);
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
};

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> out;
  for (std::string& text : texts) out.push_back(text.data());
  out.push_back(nullptr);
  return out;
}

double seconds_in(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

}  // namespace

void end_with_starter() {
  const char* told = std::getenv(kEndsWith);
  if (!told) return;
  const std::string starter = told;
  ::unsetenv(kEndsWith);  // helpers end with this process by themselves
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (std::to_string(::getppid()) != starter) ::_exit(128 + SIGKILL);  // it has ended already
}

Child::Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
             const std::filesystem::path& out, const std::filesystem::path& err, double memory)
    : began_(std::chrono::steady_clock::now()) {
  std::vector<std::string> words = {program.string()}, variables;
  words.insert(words.end(), arguments.begin(), arguments.end());
  for (char** one = environ; *one; ++one) variables.push_back(*one);
  variables.push_back(fmt::format("{}={}", kEndsWith, ::getpid()));
  const SpawnPlan plan(out.string(), err.string());
  const int failed = ::posix_spawn(&process_, program.c_str(), &plan.files, &plan.attributes,
                                   pointers_to(words).data(), pointers_to(variables).data());
  if (failed == ENOSPC || failed == EDQUOT) throw cannot_write(out.string(), std::strerror(failed));
  if (failed)
    throw std::runtime_error(fmt::format("the program {} cannot be started: {}", program.string(),
                                         std::strerror(failed)));
  if (memory > 0.0) {
    const rlimit limit{static_cast<rlim_t>(memory), static_cast<rlim_t>(memory)};
    ::prlimit(process_, RLIMIT_AS, &limit, nullptr);
  }
  descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, process_, 0));
}

Child::Child(Child&& other) noexcept
    : process_(other.process_), descriptor_(other.descriptor_), began_(other.began_) {
  other.process_ = other.descriptor_ = -1;
}

Child& Child::operator=(Child&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(began_, other.began_);
  return *this;
}

Child::~Child() {
  if (process_ > 0) {
    kill();
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::optional<ChildEnd> Child::ended() {
  int status = 0;
  rusage used{};
  if (process_ <= 0 || ::wait4(process_, &status, WNOHANG, &used) != process_) return {};
  process_ = -1;
  ChildEnd out;
  out.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  out.status = out.signal ? 128 + out.signal : WEXITSTATUS(status);
  out.seconds = seconds();
  out.cpu = seconds_in(used.ru_utime) + seconds_in(used.ru_stime);
  constexpr double kUnit = 1024.0;  // getrusage(2)
  out.memory = kUnit * static_cast<double>(used.ru_maxrss);
  return out;
}

void Child::stop() const {
  if (process_ > 0) ::kill(process_, SIGTERM);
}

void Child::kill() const {
  if (process_ > 0) ::kill(-process_, SIGKILL);
}

double Child::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

}  // namespace hookeye
