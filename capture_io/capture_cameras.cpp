// Cameras and light.
#include <fmt/format.h>

#include <algorithm>

#include "capture_io/camera_pose.h"
#include "capture_io/capture_reader.h"

namespace hookeye {
namespace {

void read_size(const YamlNode& node, Camera& camera) {
  const std::string what = fmt::format("size of camera `{}`", camera.name);
  if (node.kind != YamlNode::Kind::sequence || node.items.size() != 2)
    unexpected(node, what, "[width, height] in pixels is expected");
  int* const sides[] = {&camera.width, &camera.height};
  for (int i = 0; i < 2; ++i) {
    *sides[i] = read_integer(node.items[i], what);
    if (*sides[i] < 1 || *sides[i] > 100000)
      unexpected(node.items[i], what, "1 to 100000 pixels are expected");
  }
}

void read_intrinsics(const YamlNode& node, Camera& camera) {
  const bool perspective = camera.projection == Camera::Projection::perspective;
  const std::string of = fmt::format(" of camera `{}`", camera.name);
  std::vector<std::string> keys{"fx", "fy", "cx", "cy", "distortion"};
  if (!perspective) keys = {"scale", "fx", "fy", "cx", "cy"};
  const YamlSection section(node, "intrinsics" + of, keys);
  const std::string right = perspective
                                ? "write `intrinsics: {fx: 1100, fy: 1100, cx: 399.5, cy: 299.5}`"
                                : "write `intrinsics: {scale: 10, cx: 399.5, cy: 299.5}`";
  if (!perspective && section.one_of({"scale", "fx"}) == "scale") {
    if (const YamlNode::Entry* fy = section.entry("fy"))
      throw InputError(fy->place, "intrinsics" + of + " has both `scale` and `fy`",
                       "give `scale` alone, or `fx` and `fy`");
    camera.fx = camera.fy = read_positive(*section.find("scale"), "scale" + of);
  } else {
    camera.fx = read_positive(section.need("fx", right), "fx" + of);
    camera.fy = read_positive(section.need("fy", right), "fy" + of);
  }
  camera.cx = read_number(section.need("cx", right), "cx" + of);
  camera.cy = read_number(section.need("cy", right), "cy" + of);
  if (!perspective) return;
  if (const YamlNode* distortion = section.find("distortion")) {
    camera.distortion = read_numbers(*distortion, "distortion" + of);
    if (!is_distortion_size(camera.distortion.size()))
      throw InputError(distortion->place,
                       fmt::format("distortion{} has {} numbers", of, camera.distortion.size()),
                       "0, 4, 5, 8, 12 or 14 are expected, in OpenCV's order");
    if (std::all_of(camera.distortion.begin(), camera.distortion.end(),
                    [](double d) { return d == 0; }))
      camera.distortion.clear();
  }
}

void read_pose(const YamlNode& node, Camera& camera) {
  const std::string of = fmt::format(" of camera `{}`", camera.name);
  const YamlSection pose(node, "pose" + of, {"rotation", "translation"});
  const std::string right =
      "write `pose: {rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation: [0, 0, 300]}`";
  const YamlNode& rotation = pose.need("rotation", right);
  if (rotation.kind != YamlNode::Kind::sequence || rotation.items.size() != 3)
    unexpected(rotation, "rotation" + of, "three rows of three numbers are expected");
  for (int i = 0; i < 3; ++i)
    camera.R.row(i) =
        read_vector3(rotation.items[i], fmt::format("row {} of rotation{}", i + 1, of)).transpose();
  const std::string fault = make_rotation(camera.R);
  if (!fault.empty())
    throw InputError(rotation.place, fmt::format("rotation{} {}", of, fault), rotation_rule);
  camera.t = read_vector3(pose.need("translation", right), "translation" + of);
}

/// The calibration file's camera.
Camera read_calibrated(const YamlNode& node, const std::string& name, const CaptureFolder& folder,
                       bool* has_pose) {
  const std::string what = fmt::format("calibration of camera `{}`", name);
  const std::filesystem::path file = read_file_path(node, what, folder);
  try {
    return read_opencv_calibration(file, has_pose);
  } catch (const InputError& error) {
    throw told_at(node.place, error);
  }
}

/// Rays need the distortion undone; far from the centre a polynomial may fold the picture over.
void check_lens(const Camera& camera, const Place& place, const std::string& what) {
  constexpr double kOff = 0.1;  // px
  constexpr int kSteps = 8;
  if (camera.distortion.empty()) return;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel((camera.width - 1.0) * i / kSteps,
                                  (camera.height - 1.0) * j / kSteps);
      const Ray ray = camera.ray(pixel);
      if ((camera.project(ray.origin + ray.direction) - pixel).norm() < kOff) continue;  // NaN: no
      throw InputError(
          place,
          fmt::format("the distortion of {} cannot be undone at pixel ({:.0f}, {:.0f})", what,
                      pixel.x(), pixel.y()),
          "look at its coefficients (OpenCV's order: k1, k2, p1, p2, k3 ...) and at fx");
    }
}

Camera read_camera(const YamlNode::Entry& entry, const CaptureFolder& folder) {
  const std::string what = fmt::format("camera `{}`", entry.key);
  const YamlSection section(entry.value, what,
                            {"size", "projection", "intrinsics", "pose", "calibration"});
  Camera camera;
  bool has_pose = false;
  const YamlNode* calibration = section.find("calibration");
  if (calibration) {
    if (const YamlNode::Entry* intrinsics = section.entry("intrinsics"))
      throw InputError(intrinsics->place, what + " has both `calibration` and `intrinsics`",
                       "keep one of the two");
    camera = read_calibrated(*calibration, entry.key, folder, &has_pose);
  }
  camera.name = entry.key;
  if (const YamlNode* projection = section.find("projection")) {
    if (read_choice(*projection, "projection of " + what, {"perspective", "orthographic"}) ==
        "orthographic")
      camera.projection = Camera::Projection::orthographic;
    if (calibration && camera.projection == Camera::Projection::orthographic)
      throw InputError(projection->place, "an OpenCV calibration describes a perspective camera",
                       "give `intrinsics: {scale: ...}` for an orthographic one");
  }
  if (const YamlNode* size = section.find("size"))
    read_size(*size, camera);
  else if (camera.width == 0)
    section.need("size", "write `size: [800, 600]`");
  if (!calibration)
    read_intrinsics(
        section.need("intrinsics", "give `intrinsics`, or `calibration: FILE` from OpenCV"),
        camera);
  if (const YamlNode* pose = section.find("pose"))
    read_pose(*pose, camera);
  else if (!has_pose)
    section.need("pose", "write `pose: {rotation: [...], translation: [...]}` (world to camera)");
  check_lens(camera, entry.place, what);
  return camera;
}

}  // namespace

std::vector<Camera> read_cameras(const YamlNode& node, const CaptureFolder& folder) {
  std::vector<Camera> cameras;
  for (const YamlNode::Entry& entry : read_named(node, "cameras"))
    cameras.push_back(read_camera(entry, folder));
  return cameras;
}

LightSpec read_light(const YamlNode& node) {
  const YamlSection section(node, "light", {"ambient", "sun"});
  LightSpec light;
  light.given = true;
  light.ambient = read_not_negative(section.need("ambient", "write `ambient: 0.4`"), "ambient");
  if (const YamlNode* sun = section.find("sun")) {
    const YamlSection options(*sun, "sun", {"toward", "strength"});
    const std::string right = "write `sun: {toward: [-0.3, -0.5, 0.8], strength: 0.6}`";
    const Vector3d toward = read_direction(options.need("toward", right), "toward");
    light.sun = toward * read_not_negative(options.need("strength", right), "strength of the sun");
  }
  if (light.ambient == 0 && light.sun.isZero())
    throw InputError(node.place, "the light is dark", "give ambient or sun a strength above zero");
  return light;
}

}  // namespace hookeye
