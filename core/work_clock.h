// Where the processor's time goes: CPU-seconds of all threads, by what the program was at (stage)
// and by what was worked out (part).
#pragma once

#include <array>
#include <string>

namespace hookeye {

enum class WorkPart {
  other,
  reading,        ///< photos, decoded and made ready
  meshing,        ///< meshes of the body
  equilibria,     ///< Newton's iterations, factors included
  sensitivities,  ///< derivatives of equilibria
  rays,           ///< pictures of the model and their derivatives
  motion,         ///< motion between model and photo, and what it leaves
  sums,           ///< normal equations of pixels
  finer_mesh,     ///< all that is worked out on other meshes than the capture's
};
constexpr int kWorkParts = 9;
const char* name_of(WorkPart part);

enum class WorkStage { rest, fit, diagnosis, trials, pictures };
constexpr int kWorkStages = 5;
const char* name_of(WorkStage stage);

/// Stands in a block of one thread. Blocks within it have their own part, which the outer one does
/// not count; those within finer_mesh have not.
class Working {
 public:
  explicit Working(WorkPart part);
  ~Working();
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;

 private:
  WorkPart outer_;
};

/// The stage of the whole process while it stands. For blocks that follow one another or contain
/// one another, of one thread at a time.
class WorkingAt {
 public:
  explicit WorkingAt(WorkStage stage);
  ~WorkingAt();
  WorkingAt(const WorkingAt&) = delete;
  WorkingAt& operator=(const WorkingAt&) = delete;

 private:
  WorkStage outer_;
};

struct WorkTable {
  double wall_s = 0.0;  ///< since the process began
  /// [stage][part]: CPU-seconds; `other` is what is left of the stage's own.
  std::array<std::array<double, kWorkParts>, kWorkStages> cpu_s{};
  double total() const;
};

/// Since the process began.
WorkTable worked();

}  // namespace hookeye
