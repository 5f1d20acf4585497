// Which dictionary the markers of a ChArUco board are of, where nobody has told it.
#pragma once

#include <string>

#include "calibration/calibrate.h"

namespace hookeye {

/// Sets the board's dictionary by some of the photos: the one by which most markers stand in their
/// places on this board. Returns a sentence that tells it. Throws InputError where none does, or
/// two do as well; Interrupted.
std::string find_dictionary(Board& board, const PhotoList& list, const CalibrateOptions& options);

}  // namespace hookeye
