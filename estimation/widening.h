// The form of a named effect made wider, before a second effect is asked for. Internal to discover.
#pragma once

#include "estimation/contest.h"

namespace hookeye {

/// Where no refit comes to the floor, the form of their effects may be too narrow: what it leaves
/// over looks like another effect (method.md, "Which effect is missing", 6). Each refit is fitted
/// again in the further forms of its effect (Effect::further_forms), from the one that leaves least
/// on, until one comes to the floor. A form stays where fitted and held-out photos together pay for
/// its parameters by more than a tie, and the held-out ones do not speak against it. Refits that
/// leave more than three times what the best does are left alone, as in a race.
std::optional<NumericalFailure> widen(Workspace& workspace, std::vector<Refit>& refits,
                                      const Floor& floor, const DiscoverOptions& options,
                                      const DiscoverEvents& events);

/// The last effect of `narrow` in the best of its further forms, or as it is.
std::variant<Fitted, NumericalFailure> widened(Workspace& workspace, Fitted narrow,
                                               const Floor& floor, const FitOptions& options,
                                               const DiscoverEvents& events = {});

}  // namespace hookeye
