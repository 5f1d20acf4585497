// What a search asks ahead, so that all who work on it share it. Internal to the search.
#pragma once

#include <string>
#include <vector>

#include "estimation/fit/crew.h"
#include "estimation/search/race.h"

namespace hookeye {

/// refit() of each.
void refit_ahead(Workspace& workspace, const SideBySide& alike,
                 const std::vector<const Racer*>& racers, const FitOptions& options);

/// add_effect() of each to `current`.
void add_ahead(Workspace& workspace, const SideBySide& alike, const Fitted& current,
               const std::vector<const EffectScore*>& effects, const FitOptions& options);

}  // namespace hookeye
