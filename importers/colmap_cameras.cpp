// COLMAP's camera models. With u = x/z, v = y/z its OPENCV models are OpenCV's, and the fisheye
// ones theta (1 + k1 theta^2 + ..) = cv::fisheye with the last coefficients zero.
#include <fmt/format.h>

#include <cmath>

#include "importers/colmap_model.h"
#include "importers/detail.h"

namespace hookeye::detail {
namespace {

/// Which of a model's parameters are what: `focals` 1 or 2, then cx cy, then the lens in the order
/// of ours, as indices behind them; -1 stands for zero.
struct Layout {
  const char* name;
  int number;
  size_t parameters;
  int focals;
  const char* projection;  ///< null: none of ours expresses it
  std::vector<int> lens;
};

const std::vector<Layout>& layouts() {
  static const std::vector<Layout> all = {
      {"SIMPLE_PINHOLE", 0, 3, 1, "perspective", {}},
      {"PINHOLE", 1, 4, 2, "perspective", {}},
      {"SIMPLE_RADIAL", 2, 4, 1, "perspective", {0, -1, -1, -1}},
      {"RADIAL", 3, 5, 1, "perspective", {0, 1, -1, -1}},
      {"OPENCV", 4, 8, 2, "perspective", {0, 1, 2, 3}},
      {"OPENCV_FISHEYE", 5, 8, 2, "fisheye", {0, 1, 2, 3}},
      {"FULL_OPENCV", 6, 12, 2, "perspective", {0, 1, 2, 3, 4, 5, 6, 7}},
      {"FOV", 7, 5, 2, nullptr, {}},
      {"SIMPLE_RADIAL_FISHEYE", 8, 4, 1, "fisheye", {0, -1, -1, -1}},
      {"RADIAL_FISHEYE", 9, 5, 1, "fisheye", {0, 1, -1, -1}},
      {"THIN_PRISM_FISHEYE", 10, 12, 2, nullptr, {}},
      {"RAD_TAN_THIN_PRISM_FISHEYE", 11, 16, 2, nullptr, {}}};
  return all;
}

std::string names_read() {
  std::string names;
  for (const Layout& layout : layouts())
    if (layout.projection) names += (names.empty() ? "" : ", ") + std::string(layout.name);
  return names;
}

}  // namespace

ColmapCameraKind colmap_camera_kind(int number) {
  for (const Layout& layout : layouts())
    if (layout.number == number) return {layout.name, layout.parameters};
  return {};
}

Camera colmap_camera(const std::string& model, const std::vector<double>& parameters,
                     const Place& place) {
  const Layout* layout = nullptr;
  for (const Layout& one : layouts())
    if (one.name == model) layout = &one;
  if (!layout || !layout->projection)
    throw InputError(
        place,
        fmt::format("camera model {} is {}", model,
                    layout ? "none that a capture can express" : "not known"),
        "convert it (colmap model_converter, image_undistorter) to one of " + names_read());
  if (parameters.size() != layout->parameters)
    throw InputError(place, fmt::format("{} has {} parameters", model, parameters.size()),
                     fmt::format("{} of them", layout->parameters));
  Camera camera;
  camera.model = &camera_model(layout->projection);
  const auto focals = static_cast<size_t>(layout->focals);
  camera.fx = parameters[0], camera.fy = parameters[focals - 1];
  camera.cx = parameters[focals], camera.cy = parameters[focals + 1];
  for (const int k : layout->lens)
    camera.distortion.push_back(k < 0 ? 0.0 : parameters[focals + 2 + static_cast<size_t>(k)]);
  for (const double parameter : parameters)
    if (!std::isfinite(parameter))
      throw InputError(place, "a parameter is not finite", "finite numbers");
  if (!(camera.fx > 0 && camera.fy > 0))
    throw InputError(place, "the focal length is not above zero", "a model with positive ones");
  move_pixel_centre(camera);
  return camera;
}

}  // namespace hookeye::detail
