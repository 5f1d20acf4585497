#include "core/work_clock.h"

#include <atomic>
#include <chrono>
#include <ctime>

namespace hookeye {

namespace {

double seconds_of(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

struct Totals {
  std::array<std::array<std::atomic<double>, kWorkParts>, kWorkStages> parts{};
  std::array<std::atomic<double>, kWorkStages> stages{};
  std::atomic<WorkStage> stage{WorkStage::rest};
  std::atomic<double> stage_since{0.0};  ///< of the process' CPU time
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
};
Totals totals;

struct OfThread {
  WorkPart part = WorkPart::other;
  double since = 0.0;
};
thread_local OfThread own;

/// What the thread has worked since the last call goes to its present part.
void settle() {
  const double now = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  if (own.part != WorkPart::other)
    totals.parts[static_cast<int>(totals.stage.load())][static_cast<int>(own.part)] +=
        now - own.since;
  own.since = now;
}

void settle_stage() {
  const double now = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  totals.stages[static_cast<int>(totals.stage.load())] += now - totals.stage_since.exchange(now);
}

}  // namespace

const char* name_of(WorkPart part) {
  constexpr const char* kNames[kWorkParts] = {"other",      "reading",       "meshing",
                                              "equilibria", "sensitivities", "rays",
                                              "motion",     "sums",          "finer mesh"};
  return kNames[static_cast<int>(part)];
}

const char* name_of(WorkStage stage) {
  constexpr const char* kNames[kWorkStages] = {"rest", "fit", "diagnosis", "trials", "pictures"};
  return kNames[static_cast<int>(stage)];
}

Working::Working(WorkPart part) : outer_(own.part) {
  settle();
  if (outer_ != WorkPart::finer_mesh) own.part = part;
}

Working::~Working() {
  settle();
  own.part = outer_;
}

WorkingAt::WorkingAt(WorkStage stage) : outer_(totals.stage) {
  settle_stage();
  totals.stage = stage;
}

WorkingAt::~WorkingAt() {
  settle_stage();
  totals.stage = outer_;
}

double WorkTable::total() const {
  double sum = 0.0;
  for (const auto& stage : cpu_s)
    for (const double part : stage) sum += part;
  return sum;
}

WorkTable worked() {
  settle_stage();
  WorkTable out;
  out.wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - totals.began).count();
  for (int s = 0; s < kWorkStages; ++s) {
    double& other = out.cpu_s[s][0];
    other = totals.stages[s];
    for (int p = 1; p < kWorkParts; ++p) {
      out.cpu_s[s][p] = totals.parts[s][p];
      other -= out.cpu_s[s][p];
    }
    other = other > 0.0 ? other : 0.0;
  }
  return out;
}

}  // namespace hookeye
