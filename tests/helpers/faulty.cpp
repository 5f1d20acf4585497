// A helper that does what a library may do with a damaged file: asked for `crash`, it crashes.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <new>
#include <vector>

#include "core/helper_main.h"
#include "core/input_error.h"

namespace hookeye {
namespace {

void spin() {
  std::atomic<unsigned> turns = 0;
  while (true) ++turns;
}

void eat() {
  std::vector<std::vector<char>> all;
  while (true) all.emplace_back(std::vector<char>(size_t{8} << 20, 1));
}

std::string answer(Unpacker& request) {
  const auto task = request.take<std::string>();
  if (task == "crash") std::raise(SIGSEGV);
  if (task == "abort") std::abort();
  if (task == "exit") std::_Exit(0);
  if (task == "spin") spin();
  if (task == "eat") eat();
  if (task == "masked") std::raise(SIGINT);
  if (task == "interrupted") {
    die_of_interrupts();
    std::raise(SIGINT);  // as Ctrl-C does to all that runs in a terminal
  }
  if (task == "compute") {
    die_of_interrupts();
    spin();
  }
  if (task == "kill") std::raise(SIGKILL);  // as the kernel does when memory is out
  if (task == "refuse") throw InputError({"a.vtu", 3, 4}, "it is wrong", "be right");
  if (task == "throw") throw std::runtime_error("something else");
  if (task == "nonsense") return "\x7f\x7f";
  return Packer().put(task).put(request.take<std::vector<double>>()).take();
}

}  // namespace
}  // namespace hookeye

int main() { return hookeye::serve(hookeye::answer); }
