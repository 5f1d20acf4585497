#include "app/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace hookeye {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void on_signal(int signal) {
  if (flag.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
    return;
  }
  constexpr std::string_view said =
      "\nstopping; finished steps are kept (once more: stop at once)\n";
  // Nothing can be done here when standard error is closed.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, said.data(), said.size());
}

}  // namespace

const std::atomic<bool>& interrupted() { return flag; }

void watch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

}  // namespace hookeye
