// Textured scans, as programs for photogrammetry write them, as the body of a capture.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hookeye {

struct ImportedScan {
  /// Name and bytes: body.obj, the picture where there is one, and body.yaml without its head.
  std::vector<std::pair<std::string, std::string>> files;
  std::vector<std::string> said;  ///< what the user is to know
  std::string texture;            ///< name of the picture in `files`; "": none
  size_t vertices = 0, triangles = 0;
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  ///< [length]
};

/// By its name: obj or ply.
bool is_scan(const std::filesystem::path& file);

/// `scale`: length units of the capture in one of the scan; `scratch`: a folder to work in.
/// Triangles keep their order. Throws InputError, with the line where there is one.
ImportedScan import_scan(const std::filesystem::path& file, double scale,
                         const std::filesystem::path& scratch);

}  // namespace hookeye
