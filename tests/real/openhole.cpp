#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "real/captures.h"
#include "real/plate.h"

namespace hookeye::real {

namespace {

constexpr double kScale = 1.0 / 0.095;              // px/mm, of the data's README
constexpr double kHoleX = 193.0, kHoleY = 541.0;    // px, centroid of the dark disc in photo 00
constexpr double kTilt = 0.00317;                   // rad, of the bar's edges against the columns
constexpr double kLeft = -14.74, kWidth = 30.0;     // mm from the hole's centre
constexpr double kLowest = -80.0, kHighest = 85.0;  // mm; seen are -47.3 .. 51.4

/// Hole of 10 mm at the origin, x across, y up, the painted face in z = 0. The thickness is not
/// told; in plane stress it does not matter.
Plate bar() {
  Plate plate;
  const double edge = 6.0;
  plate.outline = {{{kLeft, kLowest}, edge},
                   {{kLeft + kWidth, kLowest}, edge},
                   {{kLeft + kWidth, kHighest}, edge},
                   {{kLeft, kHighest}, edge}};
  plate.holes = {{{0.0, 0.0}, 5.0, 1.3}};
  plate.thickness = 2.0;
  return plate;
}

std::string photo(int step) { return fmt::format("oht_cfrp_{:02d}.png", step); }

std::string end(const char* name, double y) {
  return fmt::format("  {}: {{box: [[{}, {}, -3], [{}, {}, 1]]}}\n", name, kLeft - 1, y - 0.01,
                     kLeft + kWidth + 1, y + 0.01);
}

}  // namespace

void write_openhole(const fs::path& data, const fs::path& capture, const std::vector<int>& steps) {
  fs::create_directories(capture / "photos");
  write_plate(capture / "bar.msh", bar());
  std::string text =
      "hookeye: 1\ntitle: open-hole tension, carbon/epoxy\n"
      "units: {length: mm, force: N}\n"
      "body:\n  volume: bar.msh\n  texture: {from: rest}\n"
      // Without a force only ratios of stiffness show: the shear modulus stays.
      "model:\n  material: {law: neo-hookean, mu: 19000, kappa: 41000}\n"
      "  fit: [kappa]\n";
  const double c = std::cos(kTilt), s = std::sin(kTilt);
  text += fmt::format(
      "cameras:\n  front:\n    size: [400, 1040]\n    projection: orthographic\n"
      "    intrinsics: {{scale: {:.6f}, cx: {}, cy: {}}}\n"
      "    pose: {{rotation: [[{:.8f}, {:.8f}, 0], [{:.8f}, {:.8f}, 0], [0, 0, -1]], "
      "translation: [0, 0, 500]}}\n",
      kScale, kHoleX, kHoleY, c, -s, -s, -c);
  text += "photos: {encoding: linear}\nregions:\n" + end("bottom", kLowest) + end("top", kHighest);
  text += "examples:\n";
  // Unloaded both; the second one hangs in a jaw that has moved a little.
  text += fmt::format(
      "  rest:\n    supports: [{{region: bottom, fix: [x, y, z]}}]\n"
      "    photos: {{front: photos/{}}}\n"
      "  again:\n    supports: [{{region: bottom, rigid: fit}}]\n"
      "    photos: {{front: photos/{}}}\n",
      photo(0), photo(1));
  for (int step : steps)
    text += fmt::format(
        "  step{:02d}:\n    supports: [{{region: bottom, rigid: fit}}, {{region: top, rigid: fit}}]"
        "\n    photos: {{front: photos/{}}}\n",
        step, photo(step));
  std::vector<int> used{0, 1};
  used.insert(used.end(), steps.begin(), steps.end());
  for (int step : used)
    fs::copy_file(data / "images" / photo(step), capture / "photos" / photo(step),
                  fs::copy_options::overwrite_existing);
  std::ofstream(capture / "capture.yaml") << text;
}

std::vector<DicPoint> published_displacements(const fs::path& data, int step) {
  std::ifstream in(data / "published_dic" / fmt::format("DICe_solution_{:02d}.txt", step));
  std::vector<DicPoint> points;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || !std::isdigit(static_cast<unsigned char>(line[0]))) continue;
    for (char& letter : line)
      if (letter == ',') letter = ' ';
    DicPoint p{};
    std::istringstream(line) >> p.x_px >> p.y_px >> p.u_px >> p.v_px;
    points.push_back(p);
  }
  return points;
}

}  // namespace hookeye::real
