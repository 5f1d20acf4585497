// Where the body lies for the cameras: `body: {placement: ...}`.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "capture_io/camera.h"
#include "capture_io/yaml_tree.h"

namespace hookeye {

/// x_in_cameras_frame = R x_in_body + t. All else of a capture is told in the body's frame.
struct ToldPlacement {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< [length]
  bool fit = false;                             ///< six numbers about it are fitted
};

/// `given`, `fit` or {rotation, translation, fit}. Throws InputError.
ToldPlacement read_placement(const YamlNode& node);
/// Of a whole capture; where nothing is told, both frames are one.
ToldPlacement placement_of_capture(const YamlNode& root);

/// Poses of the cameras from their frame into the body's: they then see the body where it lies.
void take_to_body(const ToldPlacement& placement, std::vector<Camera>& cameras);

}  // namespace hookeye
