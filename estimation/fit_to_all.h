// Held-out photos that are missed because values are not known well enough. Internal to discover.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "estimation/discover.h"

namespace hookeye {

/// What held-out photos may have over noise because the values that predict them are known as well
/// as they are: the 99.9 % point of |J dp|^2/N, with the covariance V of dp and the held-out
/// photos' J^T J (Satterthwaite 1946: a multiple of chi^2 with mean tr(V J^T J)/N). Linear in dp:
/// where values are known to a factor only, an order of magnitude. 0: nothing is held out.
double spread_of_held_out(const Fitted& fitted);

/// The values that the fitted examples know worst and what they are in `all`: "creep.tau 1.5 (here
/// 2.31, 0.849 .. 6.98)". Those whose standard deviation, in units of what matters, is more than
/// half the largest.
std::vector<std::string> values_hardly_known(const Fitted& fitted, const Fitted& all);

/// The model with all examples fitted, where fitted and held-out photos miss by no more than their
/// values allow: one set of values then leaves each of both at the floor, and what is measured at
/// its noise. Empty where the held-out photos are no worse than the floor, worse than the values
/// make them, or where no such set is found.
std::variant<std::optional<FitToAll>, NumericalFailure> fit_to_all(Workspace& workspace,
                                                                   const Fitted& fitted,
                                                                   const Diagnosis& diagnosis,
                                                                   const FitOptions& options);

/// Who explained the fitted photos in a contest of `steps` and does as well as the last effect of
/// `all`, or better, where all examples are fitted: that effect first; empty: nobody.
std::vector<std::string> tie_of_all(Workspace& workspace, const FitToAll& all,
                                    const std::vector<Step>& steps, const Floor& floor,
                                    size_t first_effect, const DiscoverOptions& options,
                                    const DiscoverEvents& events);

}  // namespace hookeye
