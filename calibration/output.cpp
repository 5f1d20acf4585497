#include "calibration/output.h"

#include <fmt/format.h>

#include "capture_io/camera_covariance.h"
#include "capture_io/camera_text.h"
#include "capture_io/capture_reader.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json rows_of(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (const auto& row : matrix.rowwise()) {
    Json one = Json::array();
    for (const double value : row) one.push_back(value);
    rows.push_back(std::move(one));
  }
  return rows;
}

Json board_json(const Board& board) {
  Json out = {{"kind", board_kinds()[static_cast<size_t>(board.kind)]},
              {"columns", board.columns},
              {"rows", board.rows},
              {"pitch", board.pitch}};
  if (board.kind == Board::Kind::charuco)
    out["marker"] = board.marker, out["dictionary"] = board.dictionary;
  if (board.dots()) out["diameter"] = board.diameter > 0 ? Json(board.diameter) : Json(nullptr);
  return out;
}

Json cameras_json(const Calibration& calibration, const std::string& unit) {
  Json cameras = Json::array();
  for (size_t c = 0; c < calibration.bundle.cameras.size(); ++c) {
    const Camera& camera = calibration.bundle.cameras[c];
    Json numbers = Json::array();
    for (size_t i = 0; i < calibration.errors.parameters.size(); ++i) {
      const auto& p = calibration.errors.parameters[i];
      if (p.camera != c) continue;
      numbers.push_back({{"name", p.name},
                         {"value", p.value},
                         {"standard_error", calibration.errors.error(i)},
                         {"unit", p.unit == "length" ? unit : p.unit}});
    }
    cameras.push_back({{"name", camera.name},
                       {"size", {camera.width, camera.height}},
                       {"rotation", rows_of(camera.R)},
                       {"translation", list_of(camera.t)},
                       {"rms_px", calibration.rms_px[c]},
                       {"sigma_px", calibration.bundle.sigma[c]},
                       {"parameters", std::move(numbers)}});
  }
  return cameras;
}

Json photos_json(const Calibration& calibration) {
  Json photos = Json::array();
  for (const PhotoResult& photo : calibration.photos) {
    Json one = {{"file", photo.photo.file.string()},
                {"camera", calibration.bundle.cameras[photo.photo.camera].name},
                {"instant", calibration.list.instants[photo.photo.instant]},
                {"corners", photo.corners},
                {"used", photo.used},
                {"rms_px", photo.used ? Json(photo.rms_px) : Json(nullptr)},
                {"why", photo.why}};
    if (photo.view) {
      const BoardView& view = calibration.bundle.views[*photo.view];
      const BoardPose& pose = calibration.bundle.boards[view.board];
      one["board"] = {{"rotation", rows_of(pose.R)}, {"translation", list_of(pose.t)}};
      Json corners = Json::array();
      for (size_t i = 0; i < view.ids.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        corners.push_back({view.ids[i], view.pixels(0, at), view.pixels(1, at),
                           view.residuals(0, at), view.residuals(1, at), view.used[i] != 0});
      }
      one["corners_seen"] = std::move(corners);
    }
    photos.push_back(std::move(one));
  }
  return photos;
}

}  // namespace

std::string calibrated_cameras_yaml(const Calibration& calibration, const std::string& head) {
  std::string text = head + "cameras:\n";
  for (const Camera& camera : calibration.bundle.cameras) text += camera_text(camera);
  const YamlNode root = parse_yaml(text, "cameras.yaml");
  try {
    (void)read_cameras(root.entries.at(0).value, {});
  } catch (const InputError& error) {
    throw InputError({"photos"}, "no capture takes what comes out: " + error.wrong(),
                     "a smaller --lens, or photos that show the board out to the corners of the "
                     "picture");
  }
  return text;
}

std::string calibrated_covariance_yaml(const Calibration& calibration, const std::string& unit,
                                       const std::string& head) {
  CameraCovariance out;
  for (const auto& p : calibration.errors.parameters)
    out.numbers.push_back({calibration.bundle.cameras[p.camera].name, p.name});
  out.values = calibration.errors.covariance;
  return camera_covariance_text(out, unit, head);
}

Json calibration_json(const Calibration& calibration, const std::string& unit) {
  Json names = Json::array();
  for (const auto& p : calibration.errors.parameters)
    names.push_back(calibration.bundle.cameras[p.camera].name + "." + p.name);
  return {{"hookeye", 1},
          {"unit", unit},
          {"world", calibration.world},
          {"board", board_json(calibration.bundle.board)},
          {"corners", calibration.corners},
          {"dropped", calibration.dropped},
          {"cameras", cameras_json(calibration, unit)},
          {"covariance",
           {{"parameters", std::move(names)}, {"values", rows_of(calibration.errors.covariance)}}},
          {"photos", photos_json(calibration)},
          {"warnings", calibration.warnings}};
}

}  // namespace hookeye
