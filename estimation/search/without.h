// A fitted model with an effect less. Internal to discover.
#pragma once

#include <optional>

#include "estimation/fit/fit.h"

namespace hookeye {

/// `fitted` without its ingredient `i`, fitted again from where it stands or, where that is nearer,
/// from where the capture's own parameters started: a modulus may have made up for the effect by
/// factors. Coarse to fine where both are far off.
std::optional<Fitted> fit_without(Workspace& workspace, const Fitted& fitted, size_t i,
                                  const FitOptions& options);

/// The 95 % intervals of all values of its ingredient `i` hold what they are where it is not there.
/// (Never of a mesh.)
bool holds_null(const Fitted& fitted, size_t i);

}  // namespace hookeye
