// Single square markers (ArUco, AprilTag) in a photo. OpenCV finds them in a helper.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "capture_io/image.h"

namespace hookeye {

struct SeenTag {
  int id = 0;
  /// Corners of the black square as one reads the tag: upper left, then clockwise. Centres of
  /// pixels are at integers [px].
  Eigen::Matrix<double, 2, 4> corners;
};

/// Tags of a dictionary ("4X4_50") in the photo, by id; one that is seen twice is none. Throws
/// InputError where OpenCV gives up on the photo.
std::vector<SeenTag> find_tags(const Image& photo, const std::string& dictionary,
                               const std::string& file);

}  // namespace hookeye
