// Photos of drawn boards in a folder, and what a calibration from them says.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "calibration/calibrate.h"
#include "calibration/drawn_board.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

/// With the first markers of a dictionary.
DrawnBoard charuco(int columns, int rows, const std::string& dictionary = "4X4_50");

/// Photos of all cameras in a folder, NAME_07.png.
std::vector<CameraPhotos> photograph(const TemporaryFolder& folder, const DrawnBoard& drawn,
                                     const std::vector<Camera>& cameras,
                                     const std::vector<BoardPose>& poses, std::mt19937& random);

/// What calibrate() throws.
std::string refused(const Board& board, const std::vector<CameraPhotos>& photos);

}  // namespace hookeye::test
