// When photos were taken, and when they begin to differ.
#pragma once

#include <vector>

#include "proposal/inventory.h"

namespace hookeye {

/// The clock of one camera's photos.
struct PhotoClock {
  std::vector<double> seconds;  ///< of each photo in order; empty: the files do not say
  bool whole_seconds = false;
};
/// From the photos' EXIF. Times that fall are taken as not told. Whole seconds of photos at an even
/// pace are evened out.
PhotoClock photo_clock(const PhotoSeries& series);

/// When photos begin to differ from the first by more than noise.
struct PhotoMotion {
  size_t moved = 0;  ///< the first that did; 0: none, or already the second
  /// How far the texture went from photo moved - 1 to it and to each after it, in px of a reduced
  /// picture; empty: it cannot be followed.
  std::vector<double> gone;
};
/// Reads photos in order until they move.
PhotoMotion photo_motion(const PhotoSeries& series);

}  // namespace hookeye
