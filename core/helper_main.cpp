#include "core/helper_main.h"

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>

#include "core/helper.h"
#include "core/input_error.h"
#include "core/message.h"

namespace hookeye {
namespace {

using detail::Answer;
using detail::kHelperSocket;

const detail::Channel channel{kHelperSocket, detail::kHelperMemory};

void limit(__rlimit_resource which, double value) {
  rlimit both{};
  if (getrlimit(which, &both) != 0) return;
  const bool bounded = both.rlim_max != RLIM_INFINITY;
  if (bounded && value > static_cast<double>(both.rlim_max)) return;
  both.rlim_cur = static_cast<rlim_t>(value);
  setrlimit(which, &both);
}

/// [bytes]; 0: not told.
double address_space() {
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double seconds_used() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// The program is gone when its end of the socket is; also while a library computes.
void watch_the_program() {
  std::thread([] {
    pollfd one{kHelperSocket, 0, 0};
    while (::poll(&one, 1, -1) <= 0) {
    }
    ::_exit(0);
  }).detach();
}

std::pair<Answer, std::string> answered(const std::function<std::string(Unpacker&)>& answer,
                                        const std::string& request) {
  try {
    Unpacker in(request);
    const auto memory = in.take<double>(), seconds = in.take<double>();
    std::error_code ignored;
    std::filesystem::current_path(in.take<std::string>(), ignored);
    allow(memory, seconds);
    return {Answer::result, answer(in)};
  } catch (const InputError& error) {
    Packer out;
    out.put(error.place().file).put(error.place().line).put(error.place().column);
    return {Answer::input_error, out.put(error.wrong()).put(error.right()).take()};
  } catch (const std::bad_alloc&) {
    return {Answer::no_memory, ""};
  } catch (const std::length_error&) {  // of a container, before it asks for memory
    return {Answer::no_memory, ""};
  } catch (const std::exception& error) {
    return {Answer::failed, Packer().put(error.what()).take()};
  }
}

}  // namespace

void allow(double memory, double seconds) {
  const double space = address_space();
  if (space > 0.0) limit(RLIMIT_AS, space + memory);
  limit(RLIMIT_CPU, std::ceil(seconds_used() + seconds));
}

void die_of_interrupts() {
  sigset_t interrupts;
  sigemptyset(&interrupts);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&interrupts, signal);
  pthread_sigmask(SIG_UNBLOCK, &interrupts, nullptr);
}

int serve(const std::function<std::string(Unpacker&)>& answer) {
  limit(RLIMIT_CORE, 0.0);
  watch_the_program();
  while (const auto request = detail::receive_message(channel)) {
    const auto [kind, content] = answered(answer, *request);
    const char head = static_cast<char>(kind);
    allow(unlimited.memory, unlimited.seconds);  // to send it, and to receive the next one
    if (!detail::send_message(channel, {{&head, 1}, content})) break;
  }
  // Nothing is worth the time that libraries take to clean up.
  ::_exit(0);
}

}  // namespace hookeye
