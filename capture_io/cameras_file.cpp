#include "capture_io/cameras_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {

void refuse_to_overwrite_cameras(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error) || read_text(file).starts_with(kCamerasMark)) return;
  throw InputError({file.string()}, "there is another file of this name",
                   "another folder behind -o, or move the file away");
}

std::string head_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32; }, '?');
  return text + "\n";
}

std::string yaml_vector(const Eigen::Vector3d& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);  // no -0
}

}  // namespace hookeye
