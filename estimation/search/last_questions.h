// What a search asks of a model that nothing can be added to. Internal to discover.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "estimation/search/swaps.h"

namespace hookeye {

/// The step that the answer makes; empty: the model stays.
using LastAnswer = Result<std::optional<Step>>;

/// Before the photos are called unexplained the mesh is refitted, if the likelihood asks for it:
/// where a hard wall meets a coarse body its linear change is no guide, and a step with it may have
/// no equilibrium.
LastAnswer settled_mesh(Workspace& workspace, const Step& newest, const DiscoverOptions& options,
                        const DiscoverEvents& events);

/// The model without an effect that it can do without (the last of `dropped`), which leaves the
/// photos at the floor; what was added last of the others stands anew. `first_effect`: how many
/// ingredients the capture's own model has.
std::optional<Step> without_idle(Workspace& workspace, const Fitted& last, const Floor& floor,
                                 size_t first_effect, const DiscoverOptions& options,
                                 const DiscoverEvents& events);

/// Winner and loser of each contest that was held again.
using AskedAgain = std::set<std::pair<std::string, std::string>>;

/// Contests that were won by less than what was missing then are held again: a coarse mesh may
/// have let swelling pass for a suction. The losers take the winner's place in the model of the
/// last of `steps`, one after the other; and so do those that stand out beside that model, but may
/// not be added, as a mesh may err by as much: in another's place nobody says that they are small
/// (in the place of the newest name, those that were not refitted in its contest). The first who is
/// better there; or, where nobody is, the first tie.
TieAsked contests_again(Workspace& workspace, const std::vector<Step>& steps, size_t first_effect,
                        AskedAgain& asked, const RefusedSwaps& refused,
                        const DiscoverOptions& options, const DiscoverEvents& events);

/// What was added explains the fitted photos and misses the held-out ones. So did those that lost
/// to it (`losers`), and a wider form of one may miss them least: creep that levels off lost to
/// softening while it could only grow. They choose; to them its further values are not fitted.
LastAnswer wider_loser(Workspace& workspace, const Step& newest, const std::vector<Refit>& losers,
                       const DiscoverOptions& options, const DiscoverEvents& events);

}  // namespace hookeye
