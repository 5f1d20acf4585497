// Held-out photos that are missed because values are not known well enough. Internal to discover.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "estimation/fit/at_floor.h"
#include "estimation/search/discover.h"

namespace hookeye {

/// What the photos of the held-out examples (or of the fitted ones) may have over noise because the
/// values are known as well as they are: the 99.9 % point of |J dp|^2/N, with the covariance V of
/// dp and J^T J of those photos (Satterthwaite 1946: a multiple of chi^2 with mean tr(V J^T J)/N).
/// Numbers of one held-out example alone take up what they can. Linear in dp: where values are
/// known to a factor only, an order of magnitude. 0: there are no such photos.
double spread_of_photos(const Fitted& fitted, bool held_out);

/// Which values miss the held-out photos most, and what they are in `all`: "creep.tau 1.5 (here
/// 2.31, 0.849 .. 6.98)". Those that move along that direction by a tenth of what moves most.
std::vector<std::string> values_hardly_known(const Fitted& fitted, const Fitted& all);

/// The model with all examples fitted, where fitted and held-out photos miss by no more than their
/// values allow: one set of values then leaves each of both within FloorLimits::at of the floor,
/// what is measured at its noise, and the fitted photos as they were but for what values and
/// renderers (least_fall) err by. Empty where the held-out photos are at the floor, worse than the
/// values make them, or where no such set is found.
Result<std::optional<FitToAll>> fit_to_all(Workspace& workspace, const Fitted& fitted,
                                           const Diagnosis& diagnosis, const FitOptions& options);

/// For the effects of `all`, the last first: who tied with one (`tie`, of which it is the first) or
/// explained the fitted photos in a contest of `past` that it won, or who won it for it, and does
/// as well in its place where all examples are fitted. That effect first; empty: nobody.
std::vector<std::string> tie_of_all(Workspace& workspace, const FitToAll& all,
                                    const std::vector<Contested>& past,
                                    const std::vector<std::string>& tie, const Floor& floor,
                                    size_t first_effect, const DiscoverOptions& options,
                                    const DiscoverEvents& events);

}  // namespace hookeye
