#include "capture_io/capture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <stdexcept>

#include "capture_io/camera_covariance.h"
#include "capture_io/capture_reader.h"
#include "capture_io/field_start.h"
#include "capture_io/placement.h"
#include "capture_io/yaml_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

YamlNode load_capture(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    throw InputError({file.string()}, "there is no such capture",
                     "name a capture.yaml or the folder that holds one");
  return load_yaml(file, file.string());
}

/// What can only be checked once all sections are known.
void check_references(const Capture& capture) {
  const BodySpec& body = capture.body;
  if (body.texture == BodySpec::Texture::rest) {
    const auto example =
        std::find_if(capture.examples.begin(), capture.examples.end(),
                     [&](const ExampleSpec& e) { return e.name == body.texture_example; });
    if (example == capture.examples.end())
      throw InputError(
          body.texture_place,
          fmt::format("there is no example `{}` to take the texture from", body.texture_example),
          suggest(body.texture_example, names_of(capture.examples)));
    const bool has_image =
        std::any_of(example->photos.begin(), example->photos.end(),
                    [](const PhotoSpec& p) { return p.kind == PhotoSpec::Kind::image; });
    if (!has_image)
      throw InputError(
          body.texture_place,
          fmt::format("example `{}` has no photos to take the texture from", body.texture_example),
          "name an example with photos, usually the one at rest");
    if (example->validate)
      throw InputError(
          body.texture_place,
          fmt::format("example `{}` is held out: it cannot give the texture", body.texture_example),
          "name a fitted example, usually the one at rest");
  }
}

/// A lens is fitted from photos that show what it does.
void check_lenses(const Capture& capture) {
  const auto any_photo = [&](const Camera& camera, const auto& shows) {
    for (const ExampleSpec& example : capture.examples)
      for (const PhotoSpec& photo : example.photos)
        if (photo.camera == camera.name && photo.kind == PhotoSpec::Kind::image && shows(photo))
          return true;
    return false;
  };
  const bool from_photos = capture.body.texture == BodySpec::Texture::rest;
  for (const Camera& camera : capture.cameras) {
    const Place place = camera.lens_place;
    if ((camera.fit_vignetting || camera.fit_colour_zoom) && from_photos)
      throw InputError(
          place,
          fmt::format("the lens of camera `{}` is in the photos of the texture", camera.name),
          "leave it out, or give `texture: {image: FILE}`");
    if (camera.fit_vignetting && !any_photo(camera, [](const PhotoSpec&) { return true; }))
      throw InputError(
          place,
          fmt::format("no photo by camera `{}` shows brightness to fit its vignetting to",
                      camera.name),
          "leave it out: a silhouette has none");
    if ((camera.fit_colour_zoom || !camera.colour_zoom.isZero(0.0)) &&
        !any_photo(camera, [](const PhotoSpec& photo) { return photo.rgb; }))
      throw InputError(place,
                       fmt::format("no photo by camera `{}` is compared by its colours, which "
                                   "`chromatic_shift` tells apart",
                                   camera.name),
                       "write `channels: rgb` for its photos, or leave the shift out");
  }
}

/// A title stands on one line, so that none can add lines to what is said below it.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

/// Results are files EXAMPLE-CAMERA and EXAMPLE_CAMERA.
void check_file_names(const Capture& capture) {
  for (const char* joint : {"-", "_"}) {
    std::map<std::string, std::string> seen;
    for (const ExampleSpec& example : capture.examples)
      for (const PhotoSpec& photo : example.photos) {
        const std::string file = example.name + joint + photo.camera;
        const auto [other, fresh] = seen.emplace(file, example.name);
        if (!fresh)
          throw InputError(
              photo.place,
              fmt::format("results of example `{}` and of `{}` would both be called {}",
                          other->second, example.name, file),
              "rename an example or a camera");
      }
  }
}

}  // namespace

void check_version(const YamlSection& top) {
  const YamlNode& version = top.need("hookeye", "a capture begins with `hookeye: 1`");
  if (version.kind != YamlNode::Kind::scalar || version.text != "1")
    throw InputError(version.place, fmt::format("the capture has format {}", describe(version)),
                     "this program reads format 1: write `hookeye: 1`");
}

void check_together(const Capture& capture) {
  check_references(capture);
  check_lenses(capture);
  check_field_starts(capture);
  check_file_names(capture);
}

std::string read_title(const YamlNode& node) { return one_line(read_string(node, "title")); }

const std::vector<std::string>& capture_keys() {
  static const std::vector<std::string> keys{
      "hookeye",           "title", "units",  "body",    "model",   "cameras",
      "camera_covariance", "light", "photos", "regions", "examples"};
  return keys;
}

std::string Units::stress() const {
  if (length == "mm" && force == "N") return "MPa";
  if (length == "m" && force == "N") return "Pa";
  if (length == "m" && force == "kN") return "kPa";
  if (length == "mm" && force == "mN") return "kPa";
  if (length == "mm" && force == "kN") return "GPa";
  if (length == "m" && force == "mN") return "mPa";
  if (length == "um" && force == "uN") return "MPa";
  return force + "/" + length + "^2";
}

double Units::metre() const {
  if (length == "mm") return 1000.0;
  if (length == "cm") return 100.0;
  if (length == "um") return 1e6;
  return 1.0;
}

Vector3d RigidMotion::apply(const Vector3d& X) const {
  const double radians = degrees * 3.14159265358979323846 / 180.0;
  const Eigen::AngleAxisd turn(radians, axis.normalized());
  return turn * (X - center) + center + move;
}

const Camera& Capture::camera(const std::string& name) const {
  for (const Camera& camera : cameras)
    if (camera.name == name) return camera;
  throw std::out_of_range("Capture: no camera " + name);
}

const RegionSpec* Capture::region(const std::string& name) const {
  for (const RegionSpec& region : regions)
    if (region.name == name) return &region;
  return nullptr;
}

Capture read_capture(const fs::path& path) {
  std::error_code error;
  const fs::path given = fs::is_directory(path, error) ? path / "capture.yaml" : path;
  const YamlNode root = load_capture(given);
  const YamlSection top(root, "the capture", capture_keys());
  check_version(top);
  Capture capture;
  capture.file = fs::canonical(given);
  capture.folder = capture.file.parent_path();
  const CaptureFolder folder{given.parent_path(), capture.folder};
  if (const YamlNode* title = top.find("title")) capture.title = read_title(*title);
  capture.units = read_units(top.need("units", "write `units: {length: mm, force: N}`"));
  capture.body = read_body(top.need("body", "write `body: {surface: rest.obj}`"), folder);
  read_model(
      top.need("model", "write `model: {material: {law: neo-hookean, mu: ..., kappa: ...}}`"),
      capture);
  if (const YamlNode* cameras = top.find("cameras"))
    capture.cameras = read_cameras(section_in_place(*cameras, "cameras", folder), folder);
  take_to_body(placement_of_capture(root), capture.cameras);
  if (const YamlNode* covariance = top.find("camera_covariance"))
    read_camera_covariance(*covariance, folder, capture);
  if (const YamlNode* light = top.find("light")) capture.light = read_light(*light);
  PhotoDefaults defaults;
  if (const YamlNode* photos = top.find("photos")) defaults = read_photo_defaults(*photos, folder);
  if (const YamlNode* regions = top.find("regions"))
    capture.regions = read_regions(*regions, folder);
  const YamlNode& examples =
      top.need("examples", "write `examples: {rest: {photos: {CAMERA: FILE}}}`");
  capture.examples =
      read_examples(section_in_place(examples, "examples", folder), capture, defaults, folder);
  check_together(capture);
  measure_calibration(capture);
  return capture;
}

}  // namespace hookeye
