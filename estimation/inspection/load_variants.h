// A load case told otherwise, each by one slip that is easily made.
#pragma once

#include <string>
#include <vector>

#include "estimation/inspection/first_guess.h"
#include "simulation/loading.h"

namespace hookeye::inspection {

struct LoadVariant {
  Place place;       ///< where the capture tells what is changed
  std::string seen;  ///< completes "the photos fit if ..."
  std::string right;
  Loading loading;
};

/// Every load and moved support of the example with its sign changed.
std::vector<LoadVariant> reversed(const CoarseModel& coarse, int e);
/// Every region that covers a part of a flat face only, covering all of it.
std::vector<LoadVariant> grown(const CoarseModel& coarse, int e, double flat_cosine,
                               double most_of_face);

}  // namespace hookeye::inspection
