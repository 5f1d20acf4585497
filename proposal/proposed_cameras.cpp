#include "proposal/proposed_cameras.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "capture_io/camera_covariance.h"
#include "capture_io/capture_reader.h"
#include "capture_io/image.h"
#include "capture_io/yaml_file.h"
#include "proposal/words.h"

namespace hookeye {

namespace fs = std::filesystem;

namespace {

const CalibrationFile& chosen_calibration(const Inventory& inventory, Questions& questions) {
  if (inventory.calibrations.empty()) {
    std::string kinds;
    for (const Importer* importer : importers())
      kinds += (kinds.empty() ? "" : ", ") + importer->name();
    throw InputError({inventory.folder.string()}, "there is no calibration of the cameras in it",
                     fmt::format("put it beside the photos, as its program wrote it; read are: {} "
                                 "(docs/import.md)",
                                 kinds));
  }
  std::vector<std::string> names;
  for (const CalibrationFile& one : inventory.calibrations)
    names.push_back(one.name(inventory.folder));
  const std::string answer = questions.ask({.name = "calibration",
                                            .text = "which calibration holds",
                                            .standard = names.front(),
                                            .choices = names,
                                            .asked = names.size() > 1});
  return inventory.calibrations[static_cast<size_t>(std::find(names.begin(), names.end(), answer) -
                                                    names.begin())];
}

ImageHeader header_of(const PhotoSeries& series) {
  return read_image_header(series.photos.begin()->second);
}

Imported read_calibration(const CalibrationFile& calibration, const PhotoSeries& series) {
  if (!calibration.importer) {
    const std::string file = calibration.sources.front().string();
    Imported out;
    out.cameras = read_cameras(load_section(file, file, "cameras"), {});
    out.world = "that of " + calibration.sources.front().filename().string();
    return out;
  }
  Imported raw;
  try {
    raw = calibration.importer->read(calibration.sources, {});
  } catch (const InputError& error) {
    throw InputError(error.place(), error.wrong(),
                     error.right() +
                         " (options are those of `hookeye import`; the cameras.yaml that "
                         "it writes goes before this file)");
  }
  ImportOptions options;
  const bool unsized_one = std::any_of(raw.cameras.begin(), raw.cameras.end(),
                                       [](const Camera& camera) { return camera.width == 0; });
  if (unsized_one) {
    const ImageHeader header = header_of(series);
    options.width = header.width, options.height = header.height;
  }
  return import_cameras(*calibration.importer, calibration.sources, options);
}

std::string letters(const std::string& name) {
  std::string out;
  for (const char c : lower(name))
    if (std::isalnum(static_cast<unsigned char>(c))) out += c;
  return out;
}

/// Of each series the camera of its name; empty unless each has one.
std::vector<size_t> by_names(const std::vector<PhotoSeries>& series,
                             const std::vector<Camera>& cameras) {
  std::vector<size_t> out;
  for (const PhotoSeries& one : series)
    for (size_t c = 0; c < cameras.size(); ++c)
      if (letters(one.camera) == letters(cameras[c].name)) out.push_back(c);
  const std::set<size_t> distinct(out.begin(), out.end());
  return out.size() == series.size() && distinct.size() == out.size() ? out : std::vector<size_t>();
}

std::string pairs_text(const std::vector<PhotoSeries>& series, const std::vector<Camera>& cameras,
                       const std::vector<size_t>& of) {
  std::string out;
  for (size_t i = 0; i < of.size(); ++i)
    out += (i ? "," : "") + series[i].camera + ":" + cameras[of[i]].name;
  return out;
}

/// "left:cam1,right:cam2" as indices of cameras.
std::vector<size_t> told_pairs(const std::string& answer, const std::vector<PhotoSeries>& series,
                               const std::vector<Camera>& cameras) {
  const std::vector<std::string> names = names_of(cameras);
  std::vector<size_t> out(series.size(), cameras.size());
  const auto refuse = [&]() {
    std::vector<std::string> photos;
    for (const PhotoSeries& one : series) photos.push_back(one.camera);
    refuse_answer("cameras", answer,
                  fmt::format("PHOTOS:CAMERA for each, with commas between; photos are of {}; "
                              "calibrated are {}",
                              fmt::join(photos, ", "), fmt::join(names, ", ")));
  };
  for (const std::string& pair : between_commas(answer)) {
    const size_t colon = pair.rfind(':');
    if (colon == std::string::npos) refuse();
    for (size_t i = 0; i < series.size(); ++i)
      if (series[i].camera == pair.substr(0, colon))
        out[i] = static_cast<size_t>(std::find(names.begin(), names.end(), pair.substr(colon + 1)) -
                                     names.begin());
  }
  if (std::find(out.begin(), out.end(), cameras.size()) != out.end() ||
      std::set<size_t>(out.begin(), out.end()).size() != out.size())
    refuse();
  return out;
}

/// Which camera took each series.
std::vector<size_t> match(const Inventory& inventory, const std::vector<Camera>& cameras,
                          Questions& questions) {
  const auto& series = inventory.series;
  if (series.size() > cameras.size())
    throw InputError(
        {inventory.folder.string()},
        fmt::format("there are photos of {} and a calibration of {}",
                    counted(series.size(), "camera"), counted(cameras.size(), "camera")),
        fmt::format("calibrate all, or move photos away; the series are {}",
                    fmt::join(
                        [&] {
                          std::vector<std::string> schemes;
                          for (const auto& one : series) schemes.push_back(one.scheme);
                          return schemes;
                        }(),
                        ", ")));
  std::vector<size_t> of = by_names(series, cameras);
  const bool by_name = !of.empty();
  if (!by_name)
    for (size_t i = 0; i < series.size(); ++i) of.push_back(i);
  const std::string standard = pairs_text(series, cameras, of);
  const std::string answer =
      questions.ask({.name = "cameras",
                     .text = "which calibrated camera took which photos",
                     .standard = standard,
                     .why = by_name ? "by their names" : "in the order of their names",
                     .asked = !by_name && cameras.size() > 1});
  return answer == standard ? of : told_pairs(answer, series, cameras);
}

/// Share of the body's box that lies in the camera's picture, none where it would be a speck.
double share_seen(const Camera& camera, const BodyFacts& body) {
  Eigen::Vector2d low(1e30, 1e30), high(-1e30, -1e30);
  int seen = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vector3d x;
    for (int i = 0; i < 3; ++i) x[i] = (corner >> i) & 1 ? body.high[i] : body.low[i];
    const Eigen::Vector2d p = camera.project(x);
    if (!p.allFinite()) continue;
    low = low.cwiseMin(p), high = high.cwiseMax(p);
    seen += p.x() > -0.1 * camera.width && p.y() > -0.1 * camera.height &&
            p.x() < 1.1 * camera.width && p.y() < 1.1 * camera.height;
  }
  const bool speck =
      seen > 0 && (high - low).norm() < 0.03 * std::hypot(camera.width, camera.height);
  return speck ? 0.0 : seen / 8.0;
}

double worst_share(const std::vector<Camera>& cameras, const BodyFacts& body, double scale) {
  double worst = 1;
  for (Camera camera : cameras) {
    camera.t *= scale;
    worst = std::min(worst, share_seen(camera, body));
  }
  return worst;
}

/// Lengths of the body in one of the calibration: that with which the body is in the pictures.
void set_scale(std::vector<Camera>& cameras, const BodyFacts& body, const std::string& world,
               Questions& questions, ProposedCameras& out) {
  double scale = 1, seen = worst_share(cameras, body, 1);
  const double as_told = seen;
  if (as_told < 0.5)
    for (const double other : {1000.0, 0.001, 10.0, 0.1, 25.4, 1 / 25.4})
      if (const double share = worst_share(cameras, body, other); share > std::max(seen, 0.7))
        seen = share, scale = other;
  CaptureQuestion question{
      .name = "camera_scale",
      .text = "lengths of the mesh in one of the calibration (metres to mm: 1000)",
      .standard = fmt::format("{:.6g}", scale),
      .asked = scale != 1};
  if (scale != 1) question.why = "with 1 the body is not in the pictures, with this it is";
  const double told = questions.ask_number(question, true);
  for (Camera& camera : cameras) camera.t *= told;
  out.scale = told;
  if (worst_share(cameras, body, 1) < 0.5)
    out.said.push_back(fmt::format(
        "not all cameras see the body where the mesh has it, as the calibration's world is {}: "
        "`hookeye place` finds where the body lies in it (docs/place.md)",
        world));
}

void check_photo_sizes(const ProposedCameras& proposed) {
  for (const auto& [camera, series] : proposed.cameras) {
    const ImageHeader header = header_of(*series);
    if (header.width == camera.width && header.height == camera.height) continue;
    throw InputError(
        {series->photos.begin()->second.string()},
        fmt::format("the photo has {} x {} px, `{}` was calibrated for {} x {}", header.width,
                    header.height, camera.name, camera.width, camera.height),
        "photos as the calibration has them, neither cropped nor scaled; or tell "
        "whose photos they are: --set cameras=PHOTOS:CAMERA,...");
  }
}

}  // namespace

ProposedCameras propose_cameras(const Inventory& inventory, const BodyFacts& body,
                                Questions& questions) {
  const CalibrationFile& calibration = chosen_calibration(inventory, questions);
  ProposedCameras out;
  out.source = (calibration.importer ? calibration.importer->name() : "hookeye") + ": " +
               calibration.name(inventory.folder);
  Imported imported = read_calibration(calibration, inventory.series.front());
  out.said = imported.said;
  const std::vector<size_t> of = match(inventory, imported.cameras, questions);
  std::vector<Camera> cameras;
  for (const size_t c : of) cameras.push_back(imported.cameras[c]);
  if (cameras.size() < imported.cameras.size())
    out.said.push_back(fmt::format("{} of the calibration without photos left out",
                                   counted(imported.cameras.size() - cameras.size(), "camera")));
  set_scale(cameras, body, imported.world, questions, out);
  for (size_t i = 0; i < cameras.size(); ++i)
    out.cameras.emplace_back(cameras[i], &inventory.series[i]);
  check_photo_sizes(out);
  const fs::path covariance = calibration.sources.front().parent_path() / kCovarianceFile;
  if (!calibration.importer && fs::is_regular_file(covariance)) out.covariance = covariance;
  return out;
}

}  // namespace hookeye
