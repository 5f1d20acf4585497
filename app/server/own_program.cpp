#include "app/server/own_program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "core/own_file.h"
#include "core/program.h"

namespace hookeye {
namespace {

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
    if (wanted() && start_program(std::move(arguments), ends[1], -1, child_) != 0) child_ = -1;
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
