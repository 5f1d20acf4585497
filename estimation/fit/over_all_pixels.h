// The last look at a model that was fitted to photos read in part: over all pixels.
#pragma once

#include "estimation/fit/fit.h"

namespace hookeye {

/// `fitted` with the sums of all pixels that the cameras took, with intervals by those, and with
/// pictures without gaps; p stays. Parameters that all pixels would move have their interval about
/// the place where those want them, one Gauss-Newton step from p. Empty: the fit has seen all
/// pixels. Photos are read again, two at a time; throws InputError where one has gone or changed.
Result<std::optional<Fitted>> over_all_pixels(Workspace& workspace, const Fitted& fitted,
                                              const FitOptions& options = {});

/// Intervals by all pixels: what is known of them already.
void take_all_pixels(AllPixels all, Fitted* fitted);

}  // namespace hookeye
