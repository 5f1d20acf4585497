#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "capture_io/interrupted.h"
#include "meshing/detail.h"

namespace hookeye::detail {

void die_quietly() {
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  for (const int fault : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGINT, SIGTERM})
    std::signal(fault, SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, 1);
  dup2(nowhere, 2);
}

Ended await(int process) {
  int status = -1;
  rusage used{};
  while (process > 0 && wait4(process, &status, 0, &used) < 0 && errno == EINTR) {
  }
  // Ctrl-C goes to both processes; the parent's handler only took note of it.
  const int signal = process > 0 && WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGINT || signal == SIGTERM) throw Interrupted();
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {process > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0,
          signal != SIGXCPU && signal != SIGKILL, seconds(used.ru_utime) + seconds(used.ru_stime)};
}

}  // namespace hookeye::detail
