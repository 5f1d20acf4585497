// How far the outline of the placed model lies from that of a photo, against what that photo's
// outline can be known to.
#pragma once

#include <optional>

#include "estimation/inspection/inspection.h"
#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Of the model's rim against the photo's outline [px of the photo].
struct OutlineGap {
  double far_px = 0.0;    ///< a quarter of the rim lies as far off, or farther. Infinite: the model
                          ///< is not in the picture
  double rough_px = 0.0;  ///< of the distances, what changes from place to place along the rim:
                          ///< speckles at the edge, a ragged background. The outline's own noise
  double extent_px = 0.0;  ///< diagonal of the model's outline
  /// What no right place has: more than noise, and more than the body may differ from its mesh.
  double most_px(const InspectionOptions& options) const;
};

/// None: the photo does not tell where the body ends. What stands still in all photos of a load (a
/// clamp, a table) is left out of the photo.
std::optional<OutlineGap> outline_gap(Sight& sight, PhotoIndex photo);

/// What contradicts the place of the body: a warning for all cameras whose photo at rest has its
/// outline elsewhere. `place` is of the first of them. None: nothing does.
std::optional<CaptureWarning> outline_doubt(Sight& sight);

}  // namespace hookeye::inspection
