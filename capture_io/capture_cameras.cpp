// Cameras and light.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

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

void read_lens(const YamlNode& node, Camera& camera) {
  const std::string what = fmt::format("distortion of camera `{}`", camera.name);
  camera.distortion = read_numbers(node, what);
  if (!camera.model->takes(camera.distortion.size()))
    throw InputError(node.place, fmt::format("{} has {} numbers", what, camera.distortion.size()),
                     camera.model->count_rule());
  if (std::all_of(camera.distortion.begin(), camera.distortion.end(),
                  [](double d) { return d == 0; }))
    camera.distortion.clear();
}

void read_intrinsics(const YamlNode& node, Camera& camera) {
  const bool central = camera.model->central();
  const std::string of = fmt::format(" of camera `{}`", camera.name);
  std::vector<std::string> keys{"fx", "fy", "cx", "cy", "skew", "distortion"};
  if (!central) keys.insert(keys.begin(), "scale");
  const YamlSection section(node, "intrinsics" + of, keys);
  const std::string right = camera.model->example();
  if (!central && section.one_of({"scale", "fx"}) == "scale") {
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
  if (const YamlNode* skew = section.find("skew")) camera.skew = read_number(*skew, "skew" + of);
  if (const YamlNode* lens = section.find("distortion")) read_lens(*lens, camera);
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

/// `fit`, which is true; else what stands there is read as numbers.
bool asks_for_fit(const YamlNode& node, const std::string& what, const char* numbers) {
  if (node.kind != YamlNode::Kind::scalar) return false;
  if (node.text == "fit") return true;
  unexpected(node, what, fmt::format("`fit` is expected, or {}", numbers));
}

/// What the lens does to brightness and colour.
void read_lens_light(const YamlSection& section, Camera& camera) {
  const auto of = [&](const char* what) {
    return fmt::format("{} of camera `{}`", what, camera.name);
  };
  const YamlNode::Entry* falls = section.entry("vignetting");
  const YamlNode::Entry* shift = section.entry("chromatic_shift");
  if (falls || shift) camera.lens_place = (shift ? shift : falls)->place;
  if (falls && !camera.model->central())
    throw InputError(falls->place, of("vignetting") + " goes by the angle to the axis",
                     "leave it out: all rays of this camera are parallel");
  if (falls) {
    const auto told = read_or_fit(falls->value, of("vignetting"), read_not_negative);
    camera.fit_vignetting = !told;
    camera.vignetting = told.value_or(0.0);
  }
  if (!shift) return;
  const std::string what = of("chromatic_shift");
  if ((camera.fit_colour_zoom = asks_for_fit(shift->value, what, "`{red: 1.0003, blue: 0.9998}`")))
    return;
  const YamlSection colours(shift->value, what, {"red", "blue"});
  const char* const names[] = {"red", "blue"};
  for (int i = 0; i < 2; ++i)
    if (const YamlNode* size = colours.find(names[i])) {
      const double factor = read_positive(*size, fmt::format("{} of {}", names[i], what));
      if (std::abs(factor - 1.0) > 0.05)
        unexpected(*size, fmt::format("{} of {}", names[i], what),
                   "the size of that colour's picture over the green one's is expected, near 1");
      camera.colour_zoom[i] = std::log(factor);
    }
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

/// Whether the lens turns space over nowhere on the way from the axis to the ray h: further out a
/// polynomial may fold the picture back, and another ray may meet the same pixel.
bool unfolded(const Camera& camera, const Eigen::Vector2d& h) {
  constexpr int kSteps = 8;
  for (int i = 1; i <= kSteps; ++i) {
    const Eigen::Vector2d at = h * i / kSteps;
    CameraModel::Jacobian3 by_point;
    camera.model->to_plane(camera.distortion, at.homogeneous(), &by_point, nullptr);
    if (!(by_point.leftCols<2>().determinant() > 0)) return false;
  }
  return true;
}

/// Rays need the lens undone, in the whole picture.
void check_lens(const Camera& told, const Place& place, const std::string& what) {
  constexpr double kOff = 0.1;  // px
  constexpr int kSteps = 8;
  if (told.straight()) return;
  Camera camera = told;
  camera.R.setIdentity(), camera.t.setZero();
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel((camera.width - 1.0) * i / kSteps,
                                  (camera.height - 1.0) * j / kSteps);
      const Ray ray = camera.ray(pixel);
      const Eigen::Vector3d on_ray = ray.origin + ray.direction;
      if ((camera.project(on_ray) - pixel).norm() < kOff &&  // NaN: no
          unfolded(camera, on_ray.head<2>() / on_ray.z()))
        continue;
      throw InputError(
          place,
          fmt::format("the distortion of {} cannot be undone at pixel ({:.0f}, {:.0f})", what,
                      pixel.x(), pixel.y()),
          camera.model->ray_rule());
    }
}

/// The kind of camera that is told. Of a calibration that does not say, the file's is taken: those
/// of cv::fisheye often do not.
void read_projection(const YamlNode& node, bool calibrated, Camera& camera) {
  const std::string what = fmt::format("projection of camera `{}`", camera.name);
  std::vector<std::string> names;
  for (const CameraModel* model : camera_models()) names.push_back(model->name());
  const CameraModel& told = camera_model(read_choice(node, what, names));
  if (calibrated) {
    if (!told.central())
      throw InputError(node.place,
                       "an OpenCV calibration describes a camera whose rays meet in a point",
                       "give `intrinsics: {scale: ...}` for an orthographic one");
    if (camera.model != &told && camera.model != camera_models().front())
      throw InputError(node.place,
                       fmt::format("{} is `{}`, its calibration is of a {} camera", what,
                                   told.name(), camera.model->name()),
                       "leave `projection` out, or give another file");
    if (!told.takes(camera.distortion.size()))
      throw InputError(node.place,
                       fmt::format("{} is `{}`, its calibration has {} coefficients", what,
                                   told.name(), camera.distortion.size()),
                       told.count_rule());
  }
  camera.model = &told;
}

Camera read_camera(const YamlNode::Entry& entry, const CaptureFolder& folder) {
  const std::string what = fmt::format("camera `{}`", entry.key);
  const YamlSection section(
      entry.value, what,
      {"size", "projection", "intrinsics", "pose", "calibration", "vignetting", "chromatic_shift"});
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
  if (const YamlNode* projection = section.find("projection"))
    read_projection(*projection, calibration != nullptr, camera);
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
  read_lens_light(section, camera);
  return camera;
}

}  // namespace

std::vector<Camera> read_cameras(const YamlNode& node, const CaptureFolder& folder) {
  std::vector<Camera> cameras;
  for (const YamlNode::Entry& entry : read_named(node, "cameras"))
    cameras.push_back(read_camera(entry, folder));
  return cameras;
}

std::optional<double> read_or_fit(const YamlNode& node, const std::string& what,
                                  double (*read)(const YamlNode&, const std::string&)) {
  if (node.kind == YamlNode::Kind::scalar && node.text == "fit") return {};
  try {
    return read(node, what);
  } catch (const InputError& error) {
    throw InputError(error.place(), error.wrong(), error.right() + ", or `fit`");
  }
}

void read_harmonics(const YamlNode& node, LightSpec& light) {
  const std::string what = "harmonics of the light";
  const std::vector<double> numbers = read_numbers(node, what);
  if (numbers.size() != harmonic_names.size())
    throw InputError(node.place, fmt::format("{} are {} numbers", what, numbers.size()),
                     fmt::format("give nine: {}", fmt::join(harmonic_names, " ")));
  if (!(numbers[0] > 0.0))
    unexpected(node.items[0], "L00 of the light, its mean over all directions,",
               "a number above zero is expected");
  light.ambient = even_by_harmonic * numbers[0];
  light.uneven = Eigen::Map<const UnevenLight>(numbers.data() + 1);
}

namespace {

/// Of the sky: the same from everywhere, or harmonics.
void read_sky(const YamlSection& section, LightSpec& light) {
  const YamlNode::Entry* harmonics = section.entry("harmonics");
  if (!harmonics) {
    light.ambient = read_not_negative(
        section.need("ambient", "write `ambient: 0.4`, or `harmonics: fit`"), "ambient");
    return;
  }
  if (section.has("ambient"))
    throw InputError(harmonics->place, "light has both `ambient` and `harmonics`",
                     "keep one of the two: an even sky is the first of the harmonics");
  const YamlNode& value = harmonics->value;
  if (value.kind != YamlNode::Kind::scalar) return read_harmonics(value, light);
  if (value.text != "fit")
    unexpected(
        value, "harmonics of the light",
        fmt::format("`fit` is expected, or nine numbers: {}", fmt::join(harmonic_names, " ")));
  light.fit_harmonics = true;
  light.given = false;
}

}  // namespace

LightSpec read_light(const YamlNode& node) {
  const YamlSection section(node, "light", {"ambient", "harmonics", "sun"});
  LightSpec light;
  light.given = true;
  read_sky(section, light);
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
