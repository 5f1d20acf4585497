// hookeye calibrate: cameras from photos of a board.
#include "calibration/calibrate.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/commands/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/validators.h"
#include "calibration/board_options.h"
#include "calibration/detection.h"
#include "calibration/files.h"
#include "calibration/output.h"
#include "capture_io/camera_covariance.h"
#include "capture_io/cameras_file.h"

namespace hookeye {
namespace {

struct CalibrateCommand {
  std::vector<std::string> photos, cameras;
  ToldBoard board;
  std::string folder, unit = "mm";
  CalibrateOptions options;
};

std::vector<CameraPhotos> cameras_of(const CalibrateCommand& told) {
  if (told.cameras.empty() == told.photos.empty())
    throw bad_calibration(
        told.photos.empty() ? "there are no photos" : "photos stand beside --camera",
        "the photos of one camera, or --camera NAME='PATTERN' for each of several");
  if (told.cameras.empty()) return {{"camera", told.photos}};
  std::vector<CameraPhotos> cameras;
  for (const std::string& text : told.cameras) {
    const size_t at = text.find('=');
    const std::string name = text.substr(0, at);
    if (at == std::string::npos || at + 1 == text.size() || !is_camera_name(name))
      throw bad_calibration(fmt::format("--camera {} names no camera and its photos", text),
                            "--camera left='calib/left_*.png'; names are letters, digits, - and _");
    const auto known = std::ranges::find(cameras, name, &CameraPhotos::name);
    if (known != cameras.end())
      known->sources.push_back(text.substr(at + 1));
    else
      cameras.push_back({name, {text.substr(at + 1)}});
  }
  return cameras;
}

double error_of(const Calibration& calibration, size_t camera, const std::string& name) {
  for (size_t i = 0; i < calibration.errors.parameters.size(); ++i)
    if (calibration.errors.parameters[i].camera == camera &&
        calibration.errors.parameters[i].name == name)
      return calibration.errors.error(i);
  return 0.0;
}

/// Decimals that show two digits of the error.
int digits_for(double error) {
  return error > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, 8) : 2;
}

/// "1200.13 +- 0.21".
std::string with_error(double value, double error) {
  const int digits = digits_for(error);
  return fmt::format("{:.{}f} +- {:.{}f}", value, digits, error, digits);
}

std::string photos_table(const Calibration& calibration) {
  std::vector<std::vector<std::string>> rows{{"photo", "corners", "used", "rms px", ""}};
  for (const PhotoResult& photo : calibration.photos)
    rows.push_back({photo.photo.file.filename().string(), std::to_string(photo.corners),
                    std::to_string(photo.used),
                    photo.used ? fmt::format("{:.3f}", photo.rms_px) : "-", photo.why});
  return table(rows);
}

std::string cameras_table(const Calibration& calibration) {
  std::vector<std::vector<std::string>> rows{{"camera", "rms px", "fx", "fy", "cx", "cy"}};
  for (size_t c = 0; c < calibration.bundle.cameras.size(); ++c) {
    const Camera& camera = calibration.bundle.cameras[c];
    const auto number = [&](const char* name, double value) {
      return with_error(value, error_of(calibration, c, name));
    };
    rows.push_back({camera.name, fmt::format("{:.3f}", calibration.rms_px[c]),
                    number("fx", camera.fx), number("fy", camera.fy), number("cx", camera.cx),
                    number("cy", camera.cy)});
  }
  return table(rows);
}

std::string places_table(const Calibration& calibration) {
  std::vector<std::vector<std::string>> rows{{"camera", "stands at", "+-"}};
  for (size_t c = 0; c < calibration.bundle.cameras.size(); ++c) {
    const Camera& camera = calibration.bundle.cameras[c];
    Eigen::Vector3d shift;
    for (int k = 0; k < 3; ++k)
      shift[k] = error_of(calibration, c, std::string("shift_") + "xyz"[k]);
    const double error = shift.norm();
    const int digits = digits_for(error);
    const Eigen::Vector3d at = camera.centre();
    rows.push_back({camera.name,
                    error > 0 ? fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", at.x(), digits, at.y(),
                                            digits, at.z(), digits)
                              : yaml_vector(at),
                    error > 0 ? fmt::format("{:.{}f}", error, digits) : "world"});
  }
  return table(rows);
}

void tell(const Calibration& calibration, const CalibrateCommand& told, Session& session) {
  const Board& board = calibration.bundle.board;
  session.say("{}", photos_table(calibration));
  session.say("{} corners of a {}; {} dropped, off by more than 4 sigma\n", calibration.corners,
              board.title(), calibration.dropped);
  session.say("{}", cameras_table(calibration));
  session.say("{}", places_table(calibration));
  session.say("{}", wrapped(fmt::format("the world is {} [{}]", calibration.world, told.unit), 2));
  for (const std::string& said : calibration.said) session.say("{}", wrapped(said, 2));
  session.say(
      "{}", wrapped(fmt::format("lengths stand on the print: {:g} {} from {}. No photo can tell "
                                "that. Measure over many of them; 1 % there is 1 % in every length",
                                board.pitch, told.unit,
                                board.dots() ? "dot to dot" : "corner to corner of a square"),
                    2));
  for (const std::string& warning : calibration.warnings) session.warn(warning);
}

Calibration calibrated(const CalibrateCommand& told, const Board& board,
                       const std::vector<CameraPhotos>& cameras, const Session& session) {
  CalibrateOptions options = told.options;
  options.cancel = &interrupted();
  std::optional<Progress> progress;
  if (!session.json)
    options.progress = [&](size_t done, size_t of) {
      if (!progress) progress.emplace("looking for the board", static_cast<int>(of));
      progress->set(static_cast<int>(done), static_cast<int>(of));
    };
  return calibrate(board, cameras, options);
}

void run_calibrate(const CalibrateCommand& told, Session& session) {
  demand_board_finder();
  const Board board = board_of(told.board);
  const std::vector<CameraPhotos> cameras = cameras_of(told);
  const std::filesystem::path folder = told.folder;
  for (const char* name : {kCamerasFile, kCovarianceFile})
    refuse_to_overwrite_cameras(folder / name);
  const Calibration calibration = calibrated(told, board, cameras, session);
  const CalibrationFiles files = write_calibration(calibration, told.unit, folder);
  session.document = calibration_json(calibration, told.unit);
  session.document["command"] = "calibrate";
  session.document["file"] = files.cameras.string();
  session.document["covariance_file"] = files.covariance.string();
  session.document["corner_maps"] = nlohmann::ordered_json::array();
  for (const auto& map : files.maps) session.document["corner_maps"].push_back(map.string());
  tell(calibration, told, session);
  session.say(
      "written to {}; a capture takes it by `cameras: {{from: cameras.yaml}}`, and how well "
      "it is known by `camera_covariance: {}`\n",
      files.cameras.string(), kCovarianceFile);
}

void add_board_options(CLI::App& command, CalibrateCommand& told) {
  command.add_option("--board", told.board.kind, "Kind of board (default: charuco)")
      ->check(CLI::IsMember(board_kinds()));
  command.add_option("--squares", told.board.squares, "Squares of the board: 7x5 (columns x rows)");
  command.add_option("--square", told.board.square, "Side of a square")->check(above_zero());
  command.add_option("--marker", told.board.marker, "Side of a marker of a ChArUco board")
      ->check(above_zero());
  command.add_option("--dictionary", told.board.dictionary,
                     "Of its markers: 4X4_50 .. (default: seen in photos)");
  command.add_option("--dots", told.board.dots, "Dots: 11x8 (in a row x rows)");
  command
      .add_option("--spacing", told.board.spacing,
                  "From dot to dot; of an asymmetric grid from row to row")
      ->check(above_zero());
  command.add_option("--diameter", told.board.diameter, "Of a dot")->check(above_zero());
  command
      .add_option("--unit", told.unit, "Unit of these lengths (default: mm); nothing is converted")
      ->check(CLI::IsMember(board_units()));
}

}  // namespace

void add_calibrate(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("calibrate", "Cameras from photos of a board, for a capture");
  const auto told = std::make_shared<CalibrateCommand>();
  command->add_option("PHOTOS", told->photos, "Of one camera: files, a folder or 'PATTERN'");
  command
      ->add_option("--camera", told->cameras,
                   "One of several: NAME='PATTERN' or NAME=FOLDER; once for each")
      ->allow_extra_args(false);
  command->add_option("-o,--out", told->folder, "Folder for cameras.yaml")->required();
  add_board_options(*command, *told);
  command
      ->add_option("--lens", told->options.lens,
                   "0, 4 (k1 k2 p1 p2), 5 (and k3; default) or 8 numbers of the lens")
      ->check(CLI::IsMember(lens_numbers()));
  command->add_option("--frame", told->options.frame,
                      "A photo: the world is the frame of its board, not the first camera's");
  command->callback(
      [&chosen, told] { chosen = [told](Session& session) { run_calibrate(*told, session); }; });
}

}  // namespace hookeye
