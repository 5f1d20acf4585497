// A sparse model of COLMAP as its files have it; for this folder alone.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "importers/importer.h"

namespace hookeye::detail {

struct ColmapImage {
  std::string name;
  Eigen::Vector4d q;  ///< w x y z of the rotation world to camera
  Eigen::Vector3d t;
  uint32_t camera = 0;
  struct Seen {
    Eigen::Vector2d pixel;  ///< the first pixel's centre is (0.5, 0.5)
    uint64_t point = 0;
  };
  std::vector<Seen> seen;
};

struct ColmapModel {
  std::map<uint32_t, Camera> cameras;  ///< pixels moved to our centre
  std::vector<ColmapImage> images;
  std::map<uint64_t, Eigen::Vector3d> points;
};

/// Parameters of COLMAP's camera model as a camera of ours. Throws InputError at `place`.
Camera colmap_camera(const std::string& model, const std::vector<double>& parameters,
                     const Place& place);
/// How many parameters a model has that COLMAP numbers so, and its name; 0: not known.
struct ColmapCameraKind {
  std::string name;
  size_t parameters = 0;
};
ColmapCameraKind colmap_camera_kind(int number);

/// cameras, images and, where there are any, points3D of a folder. Throws InputError.
ColmapModel read_colmap_text(const std::filesystem::path& folder);
ColmapModel read_colmap_binary(const std::filesystem::path& folder);

}  // namespace hookeye::detail
