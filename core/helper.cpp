#include "core/helper.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>

#include "core/helper_check.h"
#include "core/interrupted.h"
#include "core/message.h"
#include "core/own_file.h"
#include "core/wire.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using detail::Answer;

/// Everything is at its default but Ctrl-C and its like, which end the program: the helper goes
/// when the program has gone, and may be needed to write what is kept until then.
class Attributes {
 public:
  Attributes() {
    posix_spawnattr_init(&value_);
    sigset_t all, held;
    sigfillset(&all);
    sigemptyset(&held);
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT}) sigaddset(&held, signal);
    posix_spawnattr_setsigdefault(&value_, &all);
    posix_spawnattr_setsigmask(&value_, &held);
    posix_spawnattr_setflags(&value_, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  ~Attributes() { posix_spawnattr_destroy(&value_); }
  const posix_spawnattr_t* get() const { return &value_; }

 private:
  posix_spawnattr_t value_;
};

/// The helper has its channel and nothing else: libraries print, and open files are not its own.
class FileActions {
 public:
  explicit FileActions(const detail::Channel& ends) {
    posix_spawn_file_actions_init(&value_);
    posix_spawn_file_actions_adddup2(&value_, ends.socket, detail::kHelperSocket);
    posix_spawn_file_actions_adddup2(&value_, ends.memory, detail::kHelperMemory);
    posix_spawn_file_actions_addclosefrom_np(&value_, detail::kHelperMemory + 1);
    posix_spawn_file_actions_addopen(&value_, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&value_, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&value_, 2, "/dev/null", O_WRONLY, 0);
  }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  ~FileActions() { posix_spawn_file_actions_destroy(&value_); }
  const posix_spawn_file_actions_t* get() const { return &value_; }

 private:
  posix_spawn_file_actions_t value_;
};

/// A descriptor beyond those that a helper's own are laid upon.
int raised(int descriptor) {
  if (descriptor < 0 || descriptor > detail::kHelperMemory) return descriptor;
  const int high = ::fcntl(descriptor, F_DUPFD_CLOEXEC, detail::kHelperMemory + 1);
  ::close(descriptor);
  return high;
}

double seconds_of(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// Helpers that Ctrl-C ends. A process leaves the set before its number may be another's.
struct Interruptible {
  std::mutex mutex;
  std::set<pid_t> running;
  bool interrupted = false;
};
Interruptible& interruptible() {
  static auto& all = *new Interruptible;  // stays: helpers end after all that is static
  return all;
}

class Process {
 public:
  explicit Process(const std::string& name) {
    int ends[2] = {-1, -1};
    ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends);
    channel_ = {raised(ends[0]), raised(::memfd_create("hookeye", MFD_CLOEXEC))};
    const detail::Channel its{raised(ends[1]), channel_.memory};
    const fs::path program = helper_folder() / name;
    std::string argument = program.string();
    char* arguments[] = {argument.data(), nullptr};
    const bool ready = its.socket >= 0 && its.memory >= 0;
    const bool started = ready && ::posix_spawn(&process_, program.c_str(), FileActions(its).get(),
                                                Attributes().get(), arguments, environ) == 0;
    ::close(its.socket);
    if (started) return;
    close();
    throw std::runtime_error(
        ready ? fmt::format("the program {} cannot be started: install Hookeye as a whole",
                            program.string())
              : fmt::format("the helper {} cannot be talked to: too many files are open", name));
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (channel_.socket >= 0) end(false);
  }

  std::optional<std::string> ask(const std::string& head, const HelperRequest& request) {
    using namespace std::chrono;
    // It may have to be loaded on a busy machine; but sleep for ever it must not.
    const auto deadline =
        steady_clock::now() + duration_cast<steady_clock::duration>(
                                  duration<double>(600.0 + 10.0 * request.limits.seconds));
    if (request.interruptible) {
      const std::lock_guard lock(interruptible().mutex);
      if (interruptible().interrupted) throw Interrupted();
      interruptible().running.insert(process_);
    }
    if (!detail::send_message(channel_, {head, request.content})) return {};
    return detail::receive_message(channel_, deadline);
  }
  void end(bool by_force) {
    if (by_force) ::kill(process_, SIGKILL);
    close();
    {
      const std::lock_guard lock(interruptible().mutex);
      interruptible().running.erase(process_);
    }
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  struct Death {
    int status = -1;       ///< for waitpid's macros
    double seconds = 0.0;  ///< of computing
  };
  /// Where it has ended by itself; waits a moment, since its socket closes first.
  std::optional<Death> death() {
    for (int i = 0; i < 200; ++i) {
      int status = -1;
      rusage used{};
      const pid_t found = reaped(&status, &used);
      if (found != 0) {
        close();
        return Death{found > 0 ? status : -1,
                     seconds_of(used.ru_utime) + seconds_of(used.ru_stime)};
      }
      ::usleep(5000);
    }
    return {};
  }

 private:
  pid_t reaped(int* status, rusage* used) {
    const std::lock_guard lock(interruptible().mutex);
    const pid_t found = ::wait4(process_, status, WNOHANG, used);
    if (found != 0) interruptible().running.erase(process_);
    return found;
  }
  void close() {
    ::close(channel_.socket);
    ::close(channel_.memory);
    channel_ = {};
  }
  pid_t process_ = -1;
  detail::Channel channel_;
};

/// One process a name, which is kept while it answers well.
struct Slot {
  std::mutex mutex;
  std::unique_ptr<Process> process;
};

Slot& slot(const std::string& name) {
  static std::mutex mutex;
  static std::map<std::string, Slot> all;
  const std::lock_guard lock(mutex);
  return all[name];
}

std::string size_of(const fs::path& file) {
  std::error_code failed;
  const auto size = fs::file_size(file, failed);
  if (failed) return "this file";
  return size < 10'000 ? fmt::format("this file of {} bytes", size)
                       : fmt::format("this file of {:.3g} MB", static_cast<double>(size) / 1e6);
}

InputError no_memory(const HelperRequest& request) {
  return {request.place,
          fmt::format("reading {} takes too much memory", size_of(request.place.file)),
          request.right};
}

InputError not_loaded(const HelperRequest& request) {
  const std::string missing = check_helper(request.name).missing;
  return {request.place,
          fmt::format("the helper '{}', which works on this, cannot be loaded: it lacks {}",
                      request.name, missing.empty() ? "a library" : missing),
          "that library installed (`hookeye doctor` names its package)"};
}

[[noreturn]] void died(Process& process, const HelperRequest& request) {
  const auto ended = process.death();
  const auto [status, seconds] = ended.value_or(Process::Death{});
  if (!ended) process.end(true);
  constexpr int kNotLoaded = 127;  // by the loader, which misses a library
  if (ended && WIFEXITED(status) && WEXITSTATUS(status) == kNotLoaded) throw not_loaded(request);
  const int signal = ended && WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGINT || signal == SIGTERM) throw Interrupted();
  if (signal == SIGKILL) throw HelperDied(no_memory(request), false, seconds);  // by the kernel
  if (!ended || signal == SIGXCPU)
    throw HelperDied(
        {request.place, fmt::format("reading {} takes too long", size_of(request.place.file)),
         request.right},
        false, ended ? seconds : request.limits.seconds);
  throw HelperDied({request.place, request.damaged, request.right}, true, seconds);
}

[[noreturn]] void rethrow(Unpacker& from) {
  const auto file = from.take<std::string>();
  const int line = from.take<int>(), column = from.take<int>();
  const auto wrong = from.take<std::string>(), right = from.take<std::string>();
  throw InputError({file, line, column}, wrong, right);
}

}  // namespace

HelperLimits limits_for(const fs::path& file) {
  std::error_code failed;
  const auto size = static_cast<double>(fs::file_size(file, failed));
  HelperLimits limits;
  if (failed) return limits;
  limits.memory += 64.0 * size;
  limits.seconds += std::ceil(size / (1 << 20));
  return limits;
}

void interrupt_helpers() {
  const std::lock_guard lock(interruptible().mutex);
  interruptible().interrupted = true;
  for (const pid_t process : interruptible().running) ::kill(process, SIGINT);
}

fs::path helper_folder() {
  if (const char* told = std::getenv("HOOKEYE_LIBEXEC")) return told;
  std::error_code failed;
  fs::path folder = own_file().parent_path();
  constexpr int kUp = 5;  // PREFIX/lib/python3/dist-packages/hookeye/_hookeye.so
  for (int up = 0; up < kUp; ++up) {
    const fs::path found = folder / "libexec" / "hookeye";
    if (fs::is_directory(found, failed)) return found;
    folder = folder.parent_path();
  }
  throw std::runtime_error(
      "there is no folder libexec/hookeye beside the program: install Hookeye as a whole, or name "
      "the folder in HOOKEYE_LIBEXEC");
}

std::string detail::ask_helper(const HelperRequest& request) {
  std::error_code ignored;
  Packer head;
  head.put(request.limits.memory).put(request.limits.seconds);
  head.put(fs::current_path(ignored).string());
  Slot& own = slot(request.name);
  const std::lock_guard lock(own.mutex);
  // Only what has answered is asked again.
  auto process = std::move(own.process);
  if (!process) process = std::make_unique<Process>(request.name);
  std::optional<std::string> answer = process->ask(head.take(), request);
  if (!answer) died(*process, request);
  Unpacker in(*answer);
  try {
    const auto kind = in.take<Answer>();
    if (!request.once && (kind == Answer::result || kind == Answer::input_error))
      own.process = std::move(process);
    switch (kind) {
      case Answer::result:
        return *std::move(answer);
      case Answer::input_error:
        rethrow(in);
      case Answer::no_memory:
        throw HelperDied(no_memory(request), false, 0.0);
      case Answer::failed:
        throw std::runtime_error(in.take<std::string>());
    }
  } catch (const WireFault&) {
  }
  throw InputError(request.place, request.damaged, request.right);
}

}  // namespace hookeye
