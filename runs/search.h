// A search in a run: fit, diagnose, add, until what is left is noise; taken up where it stopped.
#pragma once

#include <functional>
#include <string>

#include "runs/bench.h"

namespace hookeye {

/// A refit that ended: normalised residuals, held out 0 where nothing is.
struct EndedRefit {
  std::string effect;
  double fitted = 0.0, held_out = 0.0;
};

struct SearchRequest {
  DiscoverOptions options;
  std::string command;                    ///< by whose order, for run.json
  Warn warn;                              ///< may be empty
  std::function<void(const Step&)> step;  ///< told every step that stands in the run; may be empty
  std::function<void(const EndedRefit&)> refitted;  ///< told every refit; may be empty
  std::function<void(int from)> begun;  ///< told the step that it begins from; may be empty
};

/// The search itself, from a step of the run, or with -1 from the capture's own model: the same
/// way for whoever works on it. Writes nothing. Throws Interrupted or Failed.
Discovery search_anew(const Run& run, Bench& bench, int from, DiscoverOptions options,
                      const DiscoverEvents& events);

/// Writes steps and verdict. `known`: something of it was worked out before (KeptWork). Throws
/// Interrupted or Failed; what is finished stays.
Discovery discover_into(Run& run, Bench& bench, const SearchRequest& wanted, bool known);

}  // namespace hookeye
