// Progress of long work on standard error, with its share and an estimate of the time left: a bar
// on a terminal, plain lines elsewhere.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace hookeye {

/// Thread-safe. One at a time: the newest owns the terminal's line.
class Progress {
 public:
  /// `total` steps are expected; 0: unknown, only the note is shown.
  Progress(std::string title, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// One more step is done. A plain line is printed for each note, at most every two seconds.
  void advance(const std::string& note = {});
  /// Sets the count of finished steps (and the total, where it has changed).
  void set(int done, int total, const std::string& note = {});

  /// Whether it would be a bar.
  static bool on_terminal();

  /// Clears the bar so that a log line can be printed; the bar returns with the next step.
  static void clear_line();

 private:
  using Clock = std::chrono::steady_clock;
  void show();
  double seconds_left(Clock::time_point now) const;

  std::mutex mutex_;
  std::string title_, note_;
  int done_ = 0, total_ = 0;
  bool terminal_;
  Clock::time_point start_, counted_from_, shown_;
  int first_ = 0;  ///< done when counting began anew
};

}  // namespace hookeye
