// Fitting again with one effect more, to the end.
#pragma once

#include "estimation/search/race.h"

namespace hookeye {

/// Refits with one effect: the scored candidate moved to its refit form, warm-started.
Result<Fitted> add_effect(Workspace& workspace, const Fitted& current, const EffectScore& score,
                          const FitOptions& options);

/// Goes on from where the race has left off.
Result<Fitted> refit(Workspace& workspace, const Racer& racer, const FitOptions& options);

}  // namespace hookeye
