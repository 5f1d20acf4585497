// Load cases of one evaluation shared out among processes (mpi/). All of them run the same program
// on the same capture: what they evaluate, and in which order, is the same, and so is what each
// knows afterwards, in every bit. Where nobody shares, a process works out all of them.
#pragma once

#include <vector>

#include "estimation/evaluation/evaluation.h"

namespace hookeye {

class LoadCaseShare {
 public:
  virtual ~LoadCaseShare() = default;
  virtual int processes() const = 0;
  virtual int self() const = 0;  ///< this process, from 0 on

  /// What came of a load case.
  struct Result {
    ExampleEvaluation evaluation;
    hookeye::Result<void> ended;
    double seconds = 0.0;  ///< that it took
  };
  /// Asked by all processes at once: result `i` of the process `owner[i]` reaches all others. A
  /// process that has ended meanwhile ends them too.
  virtual void exchange(const std::vector<int>& owner, std::vector<Result*> results) = 0;
};

/// Of the whole process, set before the first workspace is made and kept alive; null: not shared.
void share_load_cases(LoadCaseShare* share);
LoadCaseShare* load_case_share();

/// Which process works out each load case: longest first, each to who has least to do. Ties go to
/// the first, so that all come to the same. `seconds`: what they took last; zero: not known.
std::vector<int> dealt(const std::vector<double>& seconds, int processes);
/// The same where they were dealt `before` (empty: not yet): they stay where the longest process
/// would not be a fifth shorter. Who takes over a load case makes its pictures' memory anew, and
/// times are noisy.
std::vector<int> dealt_again(const std::vector<double>& seconds, int processes,
                             const std::vector<int>& before);

}  // namespace hookeye
