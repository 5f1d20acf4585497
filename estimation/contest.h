// One round of discover(): who is raced, who is refitted, how they rank. Internal to discover.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "estimation/discover.h"

namespace hookeye {

/// The effect stands for errors of the computation.
bool numerical(const std::string& effect);

/// Within `times` the floor on the fitted photos and on the held-out ones. The default is what
/// texture and shading errors of another renderer leave at most.
constexpr double kAtFloor = 1.3;
bool at_floor(const Fitted& fitted, const Floor& floor, double times = kAtFloor);

struct Refit {
  std::string effect;
  Fitted fitted;
  double score = 0.0;
};

struct Contest {
  std::vector<Raced> raced;
  std::vector<Refit> refits;  ///< best first
};

/// Refits the leaders of a race and scores them on fitted and held-out photos with the correlation
/// of the best of them.
std::variant<Contest, NumericalFailure> refit_leaders(Workspace& workspace, const Step& step,
                                                      const DiscoverOptions& options,
                                                      const DiscoverEvents& events);

}  // namespace hookeye
