// The form of a named effect made wider, before a second effect is asked for. Internal to discover.
#pragma once

#include "estimation/contest.h"

namespace hookeye {

/// Where an effect leaves more than the floor its form may be too narrow: what it leaves over looks
/// like another effect (method.md, "Which effect is missing", 6). The model with its ingredient
/// `at` in the best of its effect's further forms (Effect::further_forms) and of theirs, or as it
/// is. A form stays where it takes most of what is over the floor, where fitted and held-out photos
/// together pay for its parameters by more than a tie, and where the held-out ones do not speak
/// against it: else it is another effect that is missing. Of what a wide form says a plainer one
/// (Effect::plainer_form) stays where it scores as well.
std::variant<Fitted, NumericalFailure> widened(Workspace& workspace, Fitted narrow, size_t at,
                                               const Floor& floor, const FitOptions& options,
                                               const DiscoverEvents& events = {});

}  // namespace hookeye
