// Two effects at once, where the best alone does not stand. Internal to discover.
#pragma once

#include <optional>

#include "estimation/search/contest.h"

namespace hookeye {

/// Two of the refits together, where none is enough alone: each pair fitted from what the two came
/// to, with the correlation of the contest. The best pair, its first effect the one that stood
/// before the other; empty where no pair has an equilibrium.
struct Pair {
  Refit first;   ///< alone, as it was refitted
  Refit second;  ///< with both
};
Result<std::optional<Pair>> refit_pairs(Workspace& workspace, const Step& step,
                                        const Contest& contest, const DiscoverOptions& options,
                                        const DiscoverEvents& events);

/// Held-out photos speak against the best of the contest, which takes more than half of what is
/// over the floor from the fitted ones: what they lost may be the mesh's own error beside so much
/// less, or what else is missing, which a modulus had made up for. The best and, where a finer mesh
/// or another effect stands out beside it, that as the second; empty: none does, or with it they
/// speak against the best as well.
Result<std::optional<Pair>> refit_beside_best(Workspace& workspace, const Step& step,
                                              const Contest& contest,
                                              const DiscoverOptions& options,
                                              const DiscoverEvents& events);

}  // namespace hookeye
