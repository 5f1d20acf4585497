#include "app/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <string_view>
#include <thread>

#include "core/helper.h"

namespace hookeye {
namespace {

std::atomic<bool> flag{false};

sigset_t watched_signals() {
  sigset_t watched;
  sigemptyset(&watched);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&watched, signal);
  return watched;
}

/// Libraries start threads when they are loaded (OpenBLAS does). One that did not block a signal
/// would end the program by it.
void block_before_libraries(int, char**, char**) {
  const sigset_t watched = watched_signals();
  sigprocmask(SIG_BLOCK, &watched, nullptr);
}
// Called ahead of the initialisers of shared libraries (System V ABI, "Initialization and
// Termination Functions").
__attribute__((section(".preinit_array"),
               used)) void (*const first)(int, char**, char**) = block_before_libraries;

void on_signal(int signal, const sigset_t& watched) {
  if (flag.exchange(true)) {
    std::signal(signal, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &watched, nullptr);
    std::raise(signal);
    return;
  }
  constexpr std::string_view said =
      "\nstopping; all that is finished is kept (once more: stop at once)\n";
  // Nothing can be done here when standard error is closed.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, said.data(), said.size());
  interrupt_helpers();
}

}  // namespace

const std::atomic<bool>& interrupted() { return flag; }

// METIS puts a handler of its own in the place of any that stands, and jumps from it to where it
// last was, on whatever thread: of a signal that all threads block no handler hears.
void watch_interrupts() {
  const sigset_t watched = watched_signals();
  for (const int signal : {SIGINT, SIGTERM})
    std::signal(signal, SIG_DFL);  // a shell has its background jobs ignore Ctrl-C
  std::thread([watched] {
    for (int signal = 0; sigwait(&watched, &signal) == 0;) on_signal(signal, watched);
  }).detach();
}

}  // namespace hookeye
