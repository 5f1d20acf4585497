// Observations that stand in one another's places: photos of one camera in the places of other load
// cases, measured values in those of other examples.
#pragma once

#include <vector>

#include "estimation/inspection/motion.h"

namespace hookeye::inspection {

/// What stands in place i (row) against what is expected in place j (column). Two ways to expect,
/// as to first order and in equilibrium, are two tables: the one that fits better counts.
using ComparedPlaces = std::vector<std::vector<MotionSums>>;

struct ComparedWays {
  std::vector<ComparedPlaces> ways;
  /// By place: what is expected there is known but for one factor, which such places share. Of
  /// motions by forces it is the stiffness, of measured forces under prescribed motions, too.
  std::vector<char> scaled;
};

struct Exchange {
  std::vector<int> places;  ///< two or more, in ascending order
  std::vector<int> fits;    ///< by those: whose expectation what stands there fits
  double told = 0.0;        ///< share of the squares that is not as expected
  double exchanged = 0.0;   ///< the same, exchanged
};

/// Share of the squares of what stands in `places` that is left if it is what `fits` expects, in
/// the way to expect that leaves least.
double share_left(const ComparedWays& compared, const std::vector<int>& places,
                  const std::vector<int>& fits);

/// Exchanges that make what is seen fit clearly better: pairs, and cycles that pairs make up. They
/// have to do so in every element of `aspects`, as with and without the mean motion of a photo. An
/// offset that all places share, as a weight, never speaks for one.
std::vector<Exchange> exchanges(const std::vector<ComparedWays>& aspects,
                                const InspectionOptions& options);

}  // namespace hookeye::inspection
