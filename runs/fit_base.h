// The base model fitted: step 0 of a run.
#pragma once

#include <string>

#include "runs/bench.h"

namespace hookeye {

/// Where the fit begins, and by whose order (run.json keeps it).
struct BaseFit {
  ModelForm form;
  VectorXd start;
  bool additive = false;  ///< go on with the additive energy from the fitted law
  std::string command;
};

/// Fits, and writes the step and its floor into the run, which has none yet. Throws Interrupted or
/// Failed; then nothing is written. `finished`: called with the step before anything is written;
/// may throw, be empty.
Step fit_base(Run& run, Bench& bench, const BaseFit& wanted, const FitOptions& options,
              const std::function<void(const Step&)>& finished = {});

}  // namespace hookeye
