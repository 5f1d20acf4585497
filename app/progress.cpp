#include "app/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "runs/printable.h"

namespace hookeye {
namespace {

constexpr int kBarWidth = 24;
std::atomic<bool> bar_on_line{false};

size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col - 1u
                                                                            : 79u;
}

}  // namespace

bool Progress::on_terminal() {
  const char* kind = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
}

Progress::Progress(std::string title, int total)
    : title_(std::move(title)),
      total_(total),
      terminal_(on_terminal()),
      start_(Clock::now()),
      counted_from_(start_),
      shown_(start_ - std::chrono::hours(1)) {
  if (terminal_) show();
}

Progress::~Progress() { clear_line(); }

void Progress::clear_line() {
  if (bar_on_line.exchange(false)) fmt::print(stderr, "\r\033[K");
}

void Progress::advance(const std::string& note) {
  const std::lock_guard lock(mutex_);
  ++done_;
  note_ = note;
  show();
}

void Progress::set(int done, int total, const std::string& note) {
  const std::lock_guard lock(mutex_);
  if (done < done_ || total != total_) first_ = done, counted_from_ = Clock::now();
  done_ = done;
  total_ = total;
  note_ = note;
  show();
}

/// At the pace since the count began anew; 0: not known.
double Progress::seconds_left(Clock::time_point now) const {
  if (total_ <= 0 || done_ <= first_ || done_ >= total_) return 0.0;
  const double seconds = std::chrono::duration<double>(now - counted_from_).count();
  return seconds / (done_ - first_) * (total_ - done_);
}

void Progress::show() {
  const auto now = Clock::now();
  const bool last = total_ > 0 && done_ >= total_;
  if (!last && now - shown_ < std::chrono::milliseconds(terminal_ ? 80 : 2000)) return;
  shown_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  std::string line = title_;
  if (total_ > 0) {
    const int filled = std::clamp(kBarWidth * done_ / total_, 0, kBarWidth);
    if (terminal_) line += fmt::format(" [{:#<{}}{:.<{}}]", "", filled, "", kBarWidth - filled);
    line += fmt::format(" {}/{}, {:.0f} %", done_, total_, 100.0 * done_ / total_);
  }
  if (!note_.empty()) line += fmt::format(", {}", note_);
  line += fmt::format(", {:.0f} s", seconds);
  if (const double left = seconds_left(now); left >= 1.0)
    line += fmt::format(", about {:.0f} s left", left);
  line = printable(line);
  if (terminal_) {
    fmt::print(stderr, "\r{}\033[K", line.substr(0, terminal_width()));
    bar_on_line = true;
  } else {
    fmt::print(stderr, "{}\n", line);
  }
  std::fflush(stderr);
}

}  // namespace hookeye
