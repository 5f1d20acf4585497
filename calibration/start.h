// A first guess of all cameras and boards, near enough for the least squares.
#pragma once

#include <vector>

#include "calibration/bundle.h"
#include "calibration/detection.h"
#include "calibration/photos.h"

namespace hookeye {

/// Cameras one by one, then each from those that saw the same boards. Corners of views are numbered
/// anew where a board looks alike when it is turned, so that all cameras call a corner by one
/// number. `found` has an entry for each photo of `list`; those without corners have no view.
/// The world is the first camera's. `lens`: count of numbers of the lens. Throws InputError.
Bundle start_bundle(const Board& board, const std::vector<CameraPhotos>& cameras,
                    const PhotoList& list, const std::vector<Detection>& found, int lens);

}  // namespace hookeye
