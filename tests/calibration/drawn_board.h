// Photos of boards, drawn: each pixel's rays on the board, averaged, blurred, with noise.
#pragma once

#include <random>
#include <vector>

#include "calibration/bundle.h"
#include "capture_io/image.h"

namespace hookeye::test {

struct DrawnBoard {
  Board board;
  /// Cells of each marker, black rim included, row by row: true is white. ChArUco alone.
  std::vector<std::vector<bool>> markers;
  bool white_first = false;  ///< the first square is white, as OpenCV before 4.7 had it
  bool inverted = false;

  /// 0 black .. 1 white at a place on the board; grey beyond its white rim.
  double at(double x, double y) const;
  /// White squares before this one, row by row.
  int white_before(int column, int row) const;
};

struct PhotoLook {
  double blur = 0.7;    ///< sigma [px]
  double noise = 0.01;  ///< sigma [full scale]
};

/// Draws photos of one camera; R, t of `camera` are world to camera.
class BoardPhotographer {
 public:
  explicit BoardPhotographer(const Camera& camera);
  Image photo(const DrawnBoard& board, const BoardPose& pose, const PhotoLook& look,
              std::mt19937& random) const;

 private:
  Camera camera_;
  std::vector<Eigen::Vector2d> rays_;  ///< through the corners of pixels, at depth 1
};

/// `count` poses in front of a camera at the origin that looks along z: tilted to all sides by up
/// to `tilt` degrees, over the whole picture, near and far of `distance`.
std::vector<BoardPose> spread_poses(const Camera& camera, const Board& board, int count,
                                    double distance, double tilt, std::mt19937& random);

/// 640 x 480 px, f 800, with a lens; at the origin.
Camera true_camera(const std::string& name);
/// Beside it, turned towards what it looks at, and rolled by `roll` degrees.
Camera second_camera(const std::string& name, double roll);

}  // namespace hookeye::test
