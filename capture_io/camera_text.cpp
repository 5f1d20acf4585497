#include "capture_io/camera_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace hookeye {
namespace {

std::string list(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

/// What the lens does to brightness and colour.
std::string lens_text(const Camera& camera) {
  std::string out;
  if (camera.fit_vignetting)
    out += "    vignetting: fit\n";
  else if (camera.vignetting != 0.0)
    out += fmt::format("    vignetting: {}\n", camera.vignetting);
  if (camera.fit_colour_zoom)
    out += "    chromatic_shift: fit\n";
  else if (!camera.colour_zoom.isZero(0.0))
    out += fmt::format("    chromatic_shift: {{red: {}, blue: {}}}\n",
                       std::exp(camera.colour_zoom[0]), std::exp(camera.colour_zoom[1]));
  return out;
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
      "    intrinsics: {}\n{}"
      "    pose:\n      rotation: [{}]\n      translation: {}\n",
      yaml_name(camera.name), camera.width, camera.height, camera.model->name(),
      intrinsics_text(camera, [](double x) { return fmt::format("{}", x); }), lens_text(camera),
      rows, list(camera.t));
}

}  // namespace hookeye
