// How far texture moves from photo to photo; for this folder alone.
#pragma once

#include <vector>

#include "capture_io/image.h"

namespace hookeye {

/// A picture of one channel, averaged over whole blocks until no side has more than `most` pixels.
Image reduced(const Image& image, int most);

/// Mean distance that patches of texture went from the first photo to each [px]; 0 for the first.
/// Patches are followed from photo to photo. Empty where fewer than five can be followed to the
/// last. Photos of one channel and one size.
std::vector<double> tracked_motion(const std::vector<Image>& photos);

}  // namespace hookeye
