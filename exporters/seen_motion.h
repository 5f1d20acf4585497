// The residual motion of photos at points of the body. For this folder alone.
#pragma once

#include <map>
#include <utility>

#include "exporters/seen_surface.h"

namespace hookeye::detail {

/// The cells of one photo, to look up by pixel.
class MotionCells {
 public:
  /// Planes of one photo: channels of it, each with its cells.
  void add(const FlowField& flow);
  /// Weighted mean of the cells about a pixel: motion [px] and its information [1/px^2]; empty:
  /// the cells about it do not tell.
  struct Motion {
    Eigen::Vector2d u;
    Eigen::Matrix2d information;
  };
  std::optional<Motion> at(const Eigen::Vector2d& px) const;

 private:
  std::map<std::pair<int, int>, std::vector<Motion>> cells_;  ///< by column and row
  std::map<std::pair<int, int>, Eigen::Vector2d> centres_;
  int cell_px_ = 16;
};

/// Displacement that all these photos ask for at x, in the body's frame: least squares in pixels.
struct SpaceMotion {
  Vector3d u = Vector3d::Zero();
  double sigma = 0.0;  ///< of the worst of the known directions
  int known = 0;
};
SpaceMotion motion_in_space(const std::vector<std::pair<const Camera*, MotionCells::Motion>>& seen,
                            const Vector3d& x);

}  // namespace hookeye::detail
