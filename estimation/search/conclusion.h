// What a search has come to, once nothing is left to ask. Internal to discover.
#pragma once

#include <string>
#include <vector>

#include "estimation/search/contest.h"
#include "estimation/search/discover.h"

namespace hookeye {

/// A tie holds while its winner stands alone: where the winner was dropped later, or a rival was
/// found beside it, the later steps have decided.
void settle_tie(std::vector<std::string>& tie, const std::vector<std::string>& missing);

/// Sets what is missing, the verdict and the sentence of `out`, whose newest step is diagnosed, and
/// tells of it. `run`: all steps, with those of earlier searches; `refused`: the last contest's
/// best.
void conclude(Discovery& out, const std::vector<Contested>& run, const Refusal& refused,
              const Decided& decided);

}  // namespace hookeye
