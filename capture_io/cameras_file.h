// The file cameras.yaml as the program writes it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace hookeye {

/// First line of a file that the program wrote: by it, the program may write the file anew.
inline constexpr const char* kCamerasMark = "# hookeye ";
inline constexpr const char* kCamerasFile = "cameras.yaml";

/// A file of cameras that somebody wrote by hand stays. Throws InputError.
void refuse_to_overwrite_cameras(const std::filesystem::path& file);
/// `text` as a line of a file, whatever names stand in it.
std::string head_line(std::string text);
/// "(12.3, 0, -4.56)".
std::string yaml_vector(const Eigen::Vector3d& v);

}  // namespace hookeye
