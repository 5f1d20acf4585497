#include "core/program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

namespace hookeye {
namespace {

struct Pipe {
  int from = -1, to = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe is left");
    from = ends[0], to = ends[1];
  }
  ~Pipe() {
    close(from);
    close(to);
  }
  static void close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
};

/// Its end, however the one who waits for it leaves.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    (void)wait();
  }
  int wait() {
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) continue;
    id_ = -1;
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  pid_t id_;
};

/// What has come; "" at the end, where the pipe is closed.
std::string_view read_some(int& from, std::string& room) {
  for (;;) {
    const ssize_t n = ::read(from, room.data(), room.size());
    if (n > 0) return {room.data(), static_cast<size_t>(n)};
    if (n < 0 && errno == EINTR) continue;
    Pipe::close(from);
    return {};
  }
}

}  // namespace

int start_program(std::vector<std::string> words, int out, int errors, pid_t& child) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out, 1);
  if (errors < 0)
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  else
    posix_spawn_file_actions_adddup2(&actions, errors, 2);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t all, none;  // our threads have Ctrl-C blocked
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  std::vector<char*> all_words;
  for (std::string& word : words) all_words.push_back(word.data());
  all_words.push_back(nullptr);
  const int failed =
      posix_spawnp(&child, all_words.front(), &actions, &attributes, all_words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return failed;
}

ProgramEnd run_program(std::vector<std::string> words,
                       const std::function<bool(std::string_view)>& output) {
  Pipe out, errors;
  pid_t id = -1;
  if (const int failed = start_program(words, out.to, errors.to, id); failed != 0) {
    if (failed == ENOENT || failed == EACCES) return {false, 0, ""};
    throw std::runtime_error("no process is left for " + words.front());
  }
  Child child(id);
  Pipe::close(out.to);
  Pipe::close(errors.to);
  ProgramEnd end;
  std::string room(1 << 16, '\0');
  while (out.from >= 0 || errors.from >= 0) {
    pollfd ends[2] = {{out.from, POLLIN, 0}, {errors.from, POLLIN, 0}};
    if (::poll(ends, 2, -1) < 0) continue;  // a signal
    if (ends[0].revents != 0)
      if (const auto part = read_some(out.from, room); !part.empty() && !output(part)) {
        end.status = -1;
        return end;
      }
    if (ends[1].revents != 0) end.errors += read_some(errors.from, room);
  }
  end.status = child.wait();
  return end;
}

}  // namespace hookeye
