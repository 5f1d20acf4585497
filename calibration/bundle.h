// All cameras and boards at once, by least squares over all corners (Ceres).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "calibration/board.h"
#include "capture_io/camera.h"

namespace hookeye {

struct BoardPose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< world_from_board
  Eigen::Vector3d t = Eigen::Vector3d::Zero();      ///< x_in_world = R x_on_board + t [length]
};

/// What one camera saw of one board.
struct BoardView {
  size_t camera = 0, board = 0;  ///< board: index into Bundle::boards
  std::vector<int> ids;          ///< corners
  Eigen::Matrix2Xd pixels;       ///< a column each [px]
  std::vector<char> used;        ///< 0: dropped
  Eigen::Matrix2Xd residuals;    ///< the camera's picture of the corner minus `pixels` [px]
};

struct Bundle {
  Board board;
  std::vector<Camera> cameras;    ///< R, t: world to camera
  std::vector<BoardPose> boards;  ///< of each instant
  std::vector<BoardView> views;
  /// The world is the frame of this board; nothing: of the first camera.
  std::optional<size_t> world_board;
  std::vector<double> sigma;  ///< of a corner in x or y, of each camera [px]; by settle()
};

/// What one camera's lens shows of a dot is not the dot's centre: the middle of its area.
Eigen::Vector2d seen_corner(const Bundle& bundle, const BoardView& view, int id);

/// Moves cameras and boards to the least squares over used corners, in units of `sigma`. `robust`:
/// corners beyond two sigma count less. Fills residuals. Returns false where Ceres fails.
bool adjust(Bundle& bundle, bool robust);

/// adjust(), corners dropped that are off by more than four sigma (robust, each camera's own),
/// until none is. Views that keep fewer than six are dropped whole. Returns false where it fails.
bool settle(Bundle& bundle);

/// Of the numbers of the cameras; all else is allowed for.
struct BundleCovariance {
  struct Parameter {
    size_t camera;
    std::string name,
        unit;      ///< "fx", .. or "rotation_x" .., "shift_x" .. as Camera::moved() takes them
    double value;  ///< of rotation and shift 0
  };
  std::vector<Parameter> parameters;
  Eigen::MatrixXd covariance;
  double error(size_t i) const { return std::sqrt(covariance(Eigen::Index(i), Eigen::Index(i))); }
};
/// Nothing where the photos leave a number open.
std::optional<BundleCovariance> covariance(const Bundle& bundle);

}  // namespace hookeye
