// Where the silhouettes of photo and model part: what of it is a piece of its own that stands still
// while the body moves, as a clamp or a table in view does.
#pragma once

#include <optional>
#include <vector>

#include "estimation/inspection/inspection.h"
#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Of a photo against the shown state of its example. None: the photo's foreground is not known.
std::optional<Apart> apart(Sight& sight, PhotoIndex photo);

/// The pixels of such pieces in the small photo. Empty: there is no other photo to tell them by.
std::vector<unsigned char> still_beside(Sight& sight, PhotoIndex photo);

}  // namespace hookeye::inspection
