// The body's place from its outline in photos at rest.
#pragma once

#include <functional>

#include "placing/outline.h"
#include "placing/placing.h"

namespace hookeye {

struct OutlineOptions {
  /// Longest side of the pictures, coarse to fine [px]: the first finds the place from far, the
  /// last gives its figures.
  std::vector<int> look_px = {160, 320, 640};
  double turn_degrees = 35.0;  ///< of the starts about the told place, about each principal axis
  /// Told after each start: how many are done, of how many.
  std::function<void(size_t done, size_t of)> progress = {};
};

struct OutlineFit {
  Placing placing;                   ///< misfit in px of the photos, across the outlines
  std::vector<std::string> cameras;  ///< whose outlines were used, as "`front` of example `rest`"
  std::vector<std::string> why_not;  ///< of photos at rest whose outline cannot be told
};

/// From the told place of the body, some turns of it, and those shifted so that the middle of the
/// body is where the photos show it. Throws InputError where no photo at rest shows an outline, or
/// the body gets into none of them.
OutlineFit place_by_outlines(const Scene& scene, const PlacedBody& body,
                             const OutlineOptions& options);

}  // namespace hookeye
