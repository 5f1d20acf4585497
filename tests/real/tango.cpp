#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <fstream>
#include <sstream>

#include "estimation/model/photo_pyramid.h"
#include "real/captures.h"
#include "real/plate.h"
#include "real/silhouette.h"

namespace hookeye::real {

namespace {

constexpr double kScale = 25.4;  // px/mm: hole spacing 406.6 px = 16 mm
constexpr int kQuarter = 4;      // silhouettes are compared at a quarter of that
constexpr double kThickness = 2.5, kHalfWidth = 12.0;  // mm, as printed

/// The sheet as frame 0 shows it: ends and middle in px.
struct Sheet {
  const char* folder;
  const char* measured;
  double left_px, right_px, middle_px;
};
constexpr Sheet kTwoHoles{"frames_twoholes_dirA_s1", "measured_twoholes_dirA_s1.csv", 607.87,
                          1839.83, 526.5};
constexpr Sheet kNotched{"frames_smallnotch_dirA_s1", "measured_smallnotch_dirA_s1.csv", 620.23,
                         1847.65, 545.0};

double half_length(const Sheet& sheet) { return (sheet.right_px - sheet.left_px) / (2.0 * kScale); }

Plate two_holes() {
  const double a = half_length(kTwoHoles), b = kHalfWidth, edge = 3.5;
  Plate plate;
  plate.outline = {{{-a, -b}, edge}, {{a, -b}, edge}, {{a, b}, edge}, {{-a, b}, edge}};
  // Centres as fitted to frame 0 (1025.06, 425.45) and (1431.66, 627.95) px; printed with 8 mm.
  plate.holes = {{{-7.83, 3.98}, 4.0, 1.2}, {{8.18, -3.99}, 4.0, 1.2}};
  plate.thickness = kThickness;
  return plate;
}

/// Notches 0.5 mm wide, 3.06 mm straight and a tip down to 3.6 mm, at mid-length of both edges.
Plate notched() {
  const double a = half_length(kNotched), b = kHalfWidth, edge = 3.5, fine = 0.3;
  Plate plate;
  plate.outline = {{{-a, -b}, edge},
                   {{-0.25, -b}, 0.6},
                   {{-0.25, -b + 3.06}, fine},
                   {{0.0, -b + 3.6}, fine},
                   {{0.25, -b + 3.06}, fine},
                   {{0.25, -b}, 0.6},
                   {{a, -b}, edge},
                   {{a, b}, edge},
                   {{0.25, b}, 0.6},
                   {{0.25, b - 3.06}, fine},
                   {{0.0, b - 3.6}, fine},
                   {{-0.25, b - 3.06}, fine},
                   {{-0.25, b}, 0.6},
                   {{-a, b}, edge}};
  plate.thickness = kThickness;
  return plate;
}

std::string end(const char* name, double x) {
  return fmt::format("  {}: {{box: [[{}, -13, -3], [{}, 13, 1]]}}\n", name, x - 0.01, x + 0.01);
}

std::string heading(const Sheet& sheet, const std::string& title, const Tension& tension) {
  const double a = half_length(sheet);
  std::string text = fmt::format(
      "hookeye: 1\ntitle: {}\nunits: {{length: mm, force: N}}\n"
      "body:\n  volume: sheet.msh\n"
      "model:\n  material: {}\n  fit: [{}]\n"
      "cameras:\n  front:\n    size: [484, 304]\n    projection: orthographic\n"
      "    intrinsics: {{scale: {}, cx: {:.4f}, cy: {:.4f}}}\n"
      "    pose: {{rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], translation: [0, 0, 300]}}\n"
      "regions:\n",
      title, tension.material, tension.fit, kScale / kQuarter,
      (0.5 * (sheet.left_px + sheet.right_px) + 0.5) / kQuarter - 0.5,
      (sheet.middle_px + 0.5) / kQuarter - 0.5);
  return text + end("left", -a) + end("right", a) + "examples:\n";
}

/// The dark sheet, at a quarter of the size, where rims are grey by coverage. Its right end stands
/// still, so that the seed lies in it in every frame; beyond its edges the stiff ends are shaded as
/// darkly as the rim and lead on to the jaws.
void write_silhouette(const fs::path& photo, const fs::path& file, const TangoFrame& at) {
  Image stored = stored_values(photo);
  for (int y = 0; y < stored.height; ++y)
    for (int x = 0; x < stored.width; ++x)
      if (x < at.left_px || x > at.right_px)
        for (int c = 0; c < stored.channels; ++c) stored.at(x, y, c) = 1.0f;
  const Image full = silhouette(stored, 1750, 525, [](const float* p) { return p[0] < 0.57f; });
  write_image(file, halved(halved(full)));
}

const TangoFrame& frame_of(const std::vector<TangoFrame>& all, int frame) {
  return *std::find_if(all.begin(), all.end(),
                       [&](const TangoFrame& f) { return f.frame == frame; });
}

}  // namespace

std::vector<TangoFrame> tango_frames(const fs::path& data, bool notched_sheet) {
  std::ifstream in(data / (notched_sheet ? kNotched : kTwoHoles).measured);
  std::vector<TangoFrame> frames;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    for (char& letter : line)
      if (letter == ',') letter = ' ';
    std::istringstream numbers(line);
    double frame = 0, left = 0, right = 0, gap = 0;
    TangoFrame one;
    numbers >> frame >> left >> right >> gap >> one.stroke_mm >> one.force_N;
    one.frame = static_cast<int>(frame);
    one.left_px = left;
    one.right_px = right;
    if (numbers) frames.push_back(one);
  }
  return frames;
}

namespace {

std::string example(const Sheet& sheet, const fs::path& data, const fs::path& capture,
                    const Tension& tension, const TangoFrame& at, bool force) {
  const std::string photo = fmt::format("f{:03d}.png", at.frame);
  write_silhouette(data / sheet.folder / photo, capture / "photos" / photo, at);
  std::string text = fmt::format("  f{:03d}:\n", at.frame);
  if (std::count(tension.held_out.begin(), tension.held_out.end(), at.frame))
    text += "    use: validate\n";
  const std::string jaw = tension.fit_jaw
                              ? "rigid: fit"
                              : fmt::format("move: {{x: {:.4f}, y: 0, z: 0}}", -at.stroke_mm);
  text += fmt::format(
      "    supports: [{{region: right, fix: [x, y, z]}}, {{region: left, {}}}]\n"
      "    photos: {{front: {{file: photos/{}, kind: silhouette}}}}\n",
      jaw, photo);
  if (force)
    text += fmt::format("    measured: [{{force_on: left, value: [{:.4f}, 0, 0], sigma: 0.03}}]\n",
                        -(at.force_N - tension.load_cell_zero_N));
  return text;
}

void write_sheet(const Sheet& sheet, const Plate& plate, const std::string& title,
                 const fs::path& data, const fs::path& capture, const Tension& tension,
                 bool force) {
  fs::create_directories(capture / "photos");
  write_plate(capture / "sheet.msh", plate);
  std::string text = heading(sheet, title, tension);
  const auto measured = tango_frames(data, &sheet == &kNotched);
  for (int frame : tension.frames)
    text += example(sheet, data, capture, tension, frame_of(measured, frame), force);
  std::ofstream(capture / "capture.yaml") << text;
}

}  // namespace

void write_tango_holes(const fs::path& data, const fs::path& capture, const Tension& tension) {
  write_sheet(kTwoHoles, two_holes(), "elastomer sheet with two holes", data, capture, tension,
              true);
}

void write_tango_notched(const fs::path& data, const fs::path& capture, const Tension& tension) {
  write_sheet(kNotched, notched(), "elastomer sheet with two notches", data, capture, tension,
              false);
}

}  // namespace hookeye::real
