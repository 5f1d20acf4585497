// Fitting again with one effect more, to the end.
#pragma once

#include <variant>

#include "estimation/search/race.h"

namespace hookeye {

/// Refits with one effect: the scored candidate moved to its refit form, warm-started.
std::variant<Fitted, NumericalFailure> add_effect(Workspace& workspace, const Fitted& current,
                                                  const EffectScore& score,
                                                  const FitOptions& options);

/// Goes on from where the race has left off.
std::variant<Fitted, NumericalFailure> refit(Workspace& workspace, const Racer& racer,
                                             const FitOptions& options);

}  // namespace hookeye
