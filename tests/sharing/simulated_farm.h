// Many workers on one folder, by the real tickets, leases and watches, on a clock and a disk that
// are simulated: hours pass in seconds, and every run with the same seed is the same.
#pragma once

#include <string>

namespace hookeye::test {

struct Farm {
  int tasks = 10000, workers = 200;
  double seconds = 1.0;      ///< mean length of a task
  double straggling = 0.01;  ///< share of tasks that take thirty times as long
  double failing = 0.01;     ///< share of tasks that fail
  int deaths = 50;           ///< workers that something kills, each replaced half a minute later
  int out_of_sight = 5;      ///< workers that reach no disk for two minutes, but work on
  double latency = 1e-3;     ///< [s] of one operation on the disk, as of a network's
  double per_name = 4e-6;    ///< [s] more for each name in a folder that is listed
  unsigned seed = 1;
};

struct FarmResult {
  double makespan = 0.0;   ///< [s] until the last task had ended
  double working = 0.0;    ///< [s] in tasks, of all workers, those of the killed among them
  double arranging = 0.0;  ///< [s] on the disk between two tasks
  double idle = 0.0;       ///< [s] with nothing that waits
  double wasted = 0.0;     ///< [s] in tasks that did not end there
  long operations = 0;     ///< on the disk
  int done = 0, failed = 0;
  int twice = 0;      ///< tasks of which two results count
  int lost = 0;       ///< tasks that did not end
  int left_over = 0;  ///< tickets that lie anywhere else at the end
  int taken_up = 0;   ///< leases of those who were killed or out of sight
  double overhead() const { return arranging / (working + arranging); }
  std::string words() const;
};

FarmResult simulate(const Farm& farm);

}  // namespace hookeye::test
