#include "capture_io/camera_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace hookeye {
namespace {

std::string list(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

}  // namespace

std::string yaml_name(const std::string& text) {
  const bool plain = std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '/' || c == '.' || c == '-';
  });
  const bool word = text.size() > 3 && std::isalpha(static_cast<unsigned char>(text[0]));
  const bool taken = text == "true" || text == "True" || text == "null" || text == "false";
  return plain && word && !taken ? text : nlohmann::json(text).dump();
}

std::string camera_text(const Camera& camera) {
  std::string rows;
  for (int i = 0; i < 3; ++i) rows += (i ? ", " : "") + list(camera.R.row(i).transpose());
  return fmt::format(
      "  {}:\n    size: [{}, {}]\n    projection: {}\n"
      "    intrinsics: {}\n"
      "    pose:\n      rotation: [{}]\n      translation: {}\n",
      yaml_name(camera.name), camera.width, camera.height, camera.model->name(),
      intrinsics_text(camera, [](double x) { return fmt::format("{}", x); }), rows, list(camera.t));
}

}  // namespace hookeye
