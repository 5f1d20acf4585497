#include "app/server/nudged.h"

#include <Eigen/Geometry>

namespace hookeye {

ToldPlacement nudged(const ToldPlacement& told, const Camera& camera, const Eigen::Vector3d& move,
                     const Eigen::Vector3d& turn, const Eigen::Vector3d& middle) {
  const Eigen::Matrix3d camera_from_frame = camera.R * told.R.transpose();
  ToldPlacement out = told;
  if (turn.norm() > 0.0) {
    const Eigen::Matrix3d in_camera =
        Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    out.R = camera_from_frame.transpose() * in_camera * camera_from_frame * told.R;
    out.t += told.R * middle - out.R * middle;
  }
  out.t += camera_from_frame.transpose() * move;
  return out;
}

}  // namespace hookeye
