// What several importers share; for this folder alone.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "capture_io/camera.h"
#include "capture_io/yaml_tree.h"
#include "importers/importer.h"

namespace hookeye::detail {

/// The first bytes of a file, lower case; "" where there is none.
std::string head_of(const std::filesystem::path& file);
bool has_ending(const std::filesystem::path& file, const std::vector<std::string>& endings);
/// Refuses more files than one.
const std::filesystem::path& only_one(const Importer::Sources& sources);

/// The rows of an affine map [R t; 0 1]: 4 x 4, or 3 x 4. Throws InputError at `place`.
struct Motion {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
};
Motion motion_of(const std::vector<std::vector<double>>& rows, const Place& place,
                 const std::string& what);

/// Short names for photos that are told by paths: the file's name without its ending, with its
/// folders where that tells them apart.
std::vector<std::string> photo_names(const std::vector<std::string>& paths);

/// A picture whose first pixel's centre is (0.5, 0.5), as ours: (0, 0).
inline void move_pixel_centre(Camera& camera) { camera.cx -= 0.5, camera.cy -= 0.5; }

}  // namespace hookeye::detail
