// decisions.jsonl of a step: what was asked of its model, and what was decided by which number.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "capture_io/run.h"
#include "estimation/diagnosis/diagnosis.h"

namespace hookeye {

class DecisionLog {
 public:
  explicit DecisionLog(Run& run);
  /// What comes now is decided of the model of this step; what stood there goes.
  void follow(const std::filesystem::path& step);
  /// Written at once. Before any step is followed it is nobody's, and goes.
  void operator()(Decision decision);

 private:
  Run& run_;
  std::filesystem::path step_;
  std::string lines_;
  double before_ = 0.0;  ///< processor time of the decision before [s]
};

/// Which effects the newest step's diagnosis names, and why not the others.
void log_naming(Run& run, const Diagnosis& diagnosis);

/// The number of a decision, what it is and what it was held against: "log Bayes factor 354.3; a
/// name takes 5"; "": it was decided by none.
std::string number_in_words(const Decision& decision);

/// Throws InputError (file, line) where it is damaged; empty where there is none.
std::vector<Decision> decisions_of(const std::filesystem::path& step);

}  // namespace hookeye
