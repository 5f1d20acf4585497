// Where a board's corners are in a photo. OpenCV finds them in a helper (helpers/boards.cpp).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/board.h"
#include "capture_io/camera.h"
#include "capture_io/image.h"

namespace hookeye {

struct Detection {
  std::vector<int> ids;     ///< corners of the board, increasing
  Eigen::Matrix2Xd pixels;  /// a column each, centres of pixels at integers [px]
  std::string why;          ///< where there are none (or too few): what was seen instead
};

/// Whether this build can find boards; false where OpenCV's aruco was not there.
bool boards_can_be_found();

/// Fewer than six corners, or corners on one line, are none. Throws InputError for what `board` has
/// no dictionary of.
Detection detect(const Image& photo, const Board& board, const std::string& file);

/// What the photo shows instead of `board`, where that can be told: another dictionary, other
/// counts. "" where not.
std::string seen_instead(const Image& photo, const Board& board, const std::string& file);

/// What markers of one dictionary say of a photo.
struct DictionaryFit {
  std::string dictionary;
  size_t markers = 0;  ///< in their places on the board
  size_t corners = 0;  ///< of the board, found by them
};
/// Of a ChArUco board whose dictionary is not known: all that have its markers. Of those whose
/// first markers are the same ones (4X4_50 and 4X4_100), the smallest that is large enough stands
/// for all.
std::vector<DictionaryFit> try_dictionaries(const Image& photo, const Board& board,
                                            const std::string& file);
/// "17 markers of 5X5_100 are": of the dictionary of which most are seen, wherever they lie. "": a
/// few at most, as any texture shows.
std::string markers_seen(const Image& photo, const Board& board, const std::string& file);
/// So many corners make a view of the board.
inline constexpr size_t kFewestCorners = 6;

struct ViewPose {
  Eigen::Vector3d rotation;     ///< board to camera, as a rotation vector [rad]
  Eigen::Vector3d translation;  ///< [length]
};
/// A start: fx, fy, cx, cy and k1, k2 of one camera, and the pose of each board, from photos that
/// all show corners. `camera` has its size. Throws InputError where OpenCV finds none.
std::vector<ViewPose> start_camera(Camera& camera, const Board& board,
                                   const std::vector<const Detection*>& photos);

}  // namespace hookeye
