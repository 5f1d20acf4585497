// hookeye calibrate: cameras from photos of a board.
#include "calibration/calibrate.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/commands/cameras_file.h"
#include "app/commands/commands.h"
#include "app/progress.h"
#include "app/validators.h"
#include "calibration/detection.h"
#include "calibration/output.h"
#include "capture_io/camera_covariance.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

struct CalibrateCommand {
  std::vector<std::string> photos, cameras;
  std::string kind = "charuco", squares, dots, folder, unit = "mm";
  double square = 0, spacing = 0, marker = 0, diameter = 0;
  std::string dictionary;
  CalibrateOptions options;
};

InputError usage(const std::string& wrong, const std::string& right) {
  return {{"hookeye calibrate"}, wrong, right};
}

/// "7x5".
void read_counts(const std::string& option, const std::string& text, Board& board) {
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, board.columns);
  const bool middle = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  const auto second = middle ? std::from_chars(first.ptr + 1, end, board.rows) : first;
  const bool good = middle && second.ec == std::errc() && second.ptr == end;
  const int least = board.dots() ? 2 : 3;
  if (!good || board.columns < least || board.rows < least || board.columns > 200 ||
      board.rows > 200)
    throw usage(fmt::format("{} {} is no count of columns and rows", option, text),
                fmt::format("as {} 7x5, {} to 200 of each", option, least));
}

void need(bool there, const std::string& kind, const std::string& option, const std::string& what) {
  if (!there)
    throw usage(fmt::format("a board of kind {} needs {}", kind, option),
                fmt::format("{}: {}", option, what));
}

void read_dictionary(std::string name, Board& board) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
  if (name.starts_with("DICT_")) name.erase(0, 5);
  for (const std::string& known : marker_dictionaries()) {
    std::string upper = known;
    std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return std::toupper(c); });
    if (upper == name) board.dictionary = known;
  }
  if (!board.dictionary.empty()) return;
  const std::string near = nearest_name(name, marker_dictionaries());
  throw usage(fmt::format("there is no dictionary {} of markers", name),
              near.empty() ? fmt::format("one of {}", fmt::join(marker_dictionaries(), ", "))
                           : fmt::format("did you mean {}?", near));
}

Board board_of(const CalibrateCommand& told) {
  Board board;
  const auto kind = std::ranges::find(board_kinds(), told.kind) - board_kinds().begin();
  board.kind = static_cast<Board::Kind>(kind);
  const bool charuco = board.kind == Board::Kind::charuco;
  if (board.dots()) {
    need(!told.dots.empty(), told.kind, "--dots", "how many, as 11x8: in a row, and rows");
    need(told.spacing > 0, told.kind, "--spacing",
         board.kind == Board::Kind::circles
             ? "from centre to centre, as measured on the print"
             : "from row to row (half of that within a row), as measured on the print");
    read_counts("--dots", told.dots, board);
    board.pitch = told.spacing, board.diameter = told.diameter;
    const double room = board.pitch * (board.kind == Board::Kind::circles ? 1.0 : std::sqrt(2.0));
    if (board.diameter >= room)
      throw usage(fmt::format("dots of {:g} overlap at a distance of {:g}", board.diameter, room),
                  "--diameter and --spacing in one unit");
  } else {
    need(!told.squares.empty(), told.kind, "--squares", "how many, as 7x5: columns and rows");
    need(told.square > 0, told.kind, "--square", "its side, as measured on the print");
    read_counts("--squares", told.squares, board);
    board.pitch = told.square;
  }
  const bool others = board.dots() ? !told.squares.empty() || told.square > 0
                                   : !told.dots.empty() || told.spacing > 0 || told.diameter > 0;
  if (others || (!charuco && (told.marker > 0 || !told.dictionary.empty())))
    throw usage("these options belong to another kind of board than " + told.kind,
                "charuco: --squares --square --marker --dictionary; chessboard: --squares "
                "--square; circles: --dots --spacing --diameter");
  if (!charuco) return board;
  need(told.marker > 0, told.kind, "--marker", "the side of a marker, as measured on the print");
  need(!told.dictionary.empty(), told.kind, "--dictionary", "of its markers, as 4X4_50");
  if (told.marker >= told.square)
    throw usage(
        fmt::format("markers of {:g} do not fit into squares of {:g}", told.marker, told.square),
        "--marker smaller than --square");
  board.marker = told.marker;
  read_dictionary(told.dictionary, board);
  return board;
}

std::vector<CameraPhotos> cameras_of(const CalibrateCommand& told) {
  if (told.cameras.empty() == told.photos.empty())
    throw usage(told.photos.empty() ? "there are no photos" : "photos stand beside --camera",
                "the photos of one camera, or --camera NAME='PATTERN' for each of several");
  if (told.cameras.empty()) return {{"camera", told.photos}};
  std::vector<CameraPhotos> cameras;
  for (const std::string& text : told.cameras) {
    const size_t at = text.find('=');
    const std::string name = text.substr(0, at);
    const bool plain = std::ranges::all_of(
        name, [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
    if (at == std::string::npos || at == 0 || at + 1 == text.size() || !plain || at > 80)
      throw usage(fmt::format("--camera {} names no camera and its photos", text),
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
  std::optional<Progress> progress;
  if (!session.json)
    options.progress = [&](size_t done, size_t of) {
      if (!progress) progress.emplace("looking for the board", static_cast<int>(of));
      progress->set(static_cast<int>(done), static_cast<int>(of));
    };
  return calibrate(board, cameras, options);
}

void run_calibrate(const CalibrateCommand& told, Session& session) {
  if (!boards_can_be_found())
    throw usage("this build of hookeye finds no boards: it was made without OpenCV's aruco",
                "a build where libopencv-contrib-dev is installed (apt-get install "
                "libopencv-contrib-dev, then configure and build again)");
  const Board board = board_of(told);
  const std::vector<CameraPhotos> cameras = cameras_of(told);
  const fs::path folder = told.folder, file = folder / "cameras.yaml",
                 errors = folder / kCovarianceFile;
  for (const fs::path& one : {file, errors}) refuse_to_overwrite_cameras(one);
  const Calibration calibration = calibrated(told, board, cameras, session);
  const std::string head = one_line(kCamerasMark + ("calibrate " + board.title())) +
                           one_line("# the world is " + calibration.world);
  const std::string yaml =
      calibrated_cameras_yaml(calibration, head + one_line("# lengths are in " + told.unit));
  const nlohmann::ordered_json content = calibration_json(calibration, told.unit);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw cannot_write(told.folder, error.message());
  session.document = content;
  session.document["command"] = "calibrate";
  session.document["file"] = file.string();
  session.document["covariance_file"] = errors.string();
  session.document["corner_maps"] = nlohmann::ordered_json::array();
  for (size_t c = 0; c < cameras.size(); ++c) {
    const fs::path map = folder / ("corners_" + cameras[c].name + ".svg");
    write_text(map, corner_map(calibration, c));
    session.document["corner_maps"].push_back(map.string());
  }
  write_text(folder / "calibration.json", content.dump(1) + "\n");
  write_text(errors, calibrated_covariance_yaml(calibration, told.unit, head));
  write_text(file, yaml);
  tell(calibration, told, session);
  session.say(
      "written to {}; a capture takes it by `cameras: {{from: cameras.yaml}}`, and how well "
      "it is known by `camera_covariance: {}`\n",
      file.string(), kCovarianceFile);
}

void add_board_options(CLI::App& command, CalibrateCommand& told) {
  command.add_option("--board", told.kind, "Kind of board (default: charuco)")
      ->check(CLI::IsMember(board_kinds()));
  command.add_option("--squares", told.squares, "Squares of the board: 7x5 (columns x rows)");
  command.add_option("--square", told.square, "Side of a square")->check(above_zero());
  command.add_option("--marker", told.marker, "Side of a marker of a ChArUco board")
      ->check(above_zero());
  command.add_option("--dictionary", told.dictionary, "Of its markers: 4X4_50 .. APRILTAG_36h11");
  command.add_option("--dots", told.dots, "Dots: 11x8 (in a row x rows)");
  command
      .add_option("--spacing", told.spacing,
                  "From dot to dot; of an asymmetric grid from row to row")
      ->check(above_zero());
  command.add_option("--diameter", told.diameter, "Of a dot")->check(above_zero());
  command
      .add_option("--unit", told.unit, "Unit of these lengths (default: mm); nothing is converted")
      ->check(CLI::IsMember({"mm", "cm", "m", "um"}));
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
      ->check(CLI::IsMember({0, 4, 5, 8}));
  command->add_option("--frame", told->options.frame,
                      "A photo: the world is the frame of its board, not the first camera's");
  command->callback(
      [&chosen, told] { chosen = [told](Session& session) { run_calibrate(*told, session); }; });
}

}  // namespace hookeye
