// The picture of what a camera saw of the boards.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "calibration/output.h"

namespace hookeye {
namespace {

constexpr double kEnlarged = 100.0;
constexpr int kCells = 8;  ///< along the longer side

/// Of the cells of the picture those without a corner, shaded; the share of those with one.
double shade_empty(const Calibration& calibration, size_t c, std::string& svg) {
  const Camera& camera = calibration.bundle.cameras[c];
  const double side = std::max(camera.width, camera.height) / static_cast<double>(kCells);
  const int columns = static_cast<int>(std::ceil(camera.width / side - 1e-9));
  const int rows = static_cast<int>(std::ceil(camera.height / side - 1e-9));
  std::set<std::pair<int, int>> covered;
  for (const BoardView& view : calibration.bundle.views)
    for (Eigen::Index i = 0; i < view.pixels.cols(); ++i)
      if (view.camera == c && view.used[static_cast<size_t>(i)])
        covered.insert({static_cast<int>((view.pixels(0, i) + 0.5) / side),
                        static_cast<int>((view.pixels(1, i) + 0.5) / side)});
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      if (!covered.contains({column, row}))
        svg += fmt::format(
            "<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='#f3e3d3'/>\n",
            column * side - 0.5, row * side - 0.5, std::min(side, camera.width - column * side),
            std::min(side, camera.height - row * side));
  return static_cast<double>(covered.size()) / (columns * rows);
}

/// The board's outline through its farthest corners, to tell views apart.
std::string outline(const Bundle& bundle, const BoardView& view, double line) {
  const Board& board = bundle.board;
  const int last = board.corner_count() - 1, along = board.corner_columns() - 1;
  std::string points;
  for (const int id : {0, along, last, last - along}) {
    const Eigen::Vector2d at = seen_corner(bundle, view, id);
    if (!at.allFinite()) return {};
    points += fmt::format("{:.1f},{:.1f} ", at.x(), at.y());
  }
  return fmt::format("<polygon points='{}' fill='none' stroke='#b8c4d6' stroke-width='{:.2f}'/>\n",
                     points, line);
}

std::string arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& off, double line,
                  const char* colour) {
  const Eigen::Vector2d to = from + kEnlarged * off;
  const double length = (to - from).norm();
  std::string path =
      fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", from.x(), from.y(), to.x(), to.y());
  if (length > 4 * line) {
    const Eigen::Vector2d back = -(to - from) / length * std::min(6 * line, 0.4 * length);
    for (const double angle : {0.45, -0.45}) {
      const double c = std::cos(angle), s = std::sin(angle);
      path +=
          fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", to.x(), to.y(),
                      to.x() + c * back.x() - s * back.y(), to.y() + s * back.x() + c * back.y());
    }
  }
  return fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='{:.2f}'/>\n", path, colour,
                     line);
}

std::string views_of_camera(const Calibration& calibration, size_t c, double line) {
  std::string outlines, dots, arrows;
  for (const BoardView& view : calibration.bundle.views) {
    if (view.camera != c) continue;
    outlines += outline(calibration.bundle, view, line);
    for (Eigen::Index i = 0; i < view.pixels.cols(); ++i) {
      const bool used = view.used[static_cast<size_t>(i)] != 0;
      const Eigen::Vector2d at = view.pixels.col(i);
      dots += fmt::format("<circle cx='{:.2f}' cy='{:.2f}' r='{:.2f}' fill='{}'/>\n", at.x(),
                          at.y(), (used ? 1.5 : 2.5) * line, used ? "#2b5ea8" : "#d03030");
      if (used) arrows += arrow(at, -view.residuals.col(i), line, "#111");
    }
  }
  return outlines + dots + arrows;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

}  // namespace

std::string corner_map(const Calibration& calibration, size_t c) {
  const Camera& camera = calibration.bundle.cameras[c];
  const double unit =
      std::max(camera.width, camera.height) / 1000.0;  // a thousandth of the picture
  const double foot = 70 * unit, rim = 10 * unit;
  std::string cells;
  const double share = shade_empty(calibration, c, cells);
  size_t views = 0, dropped = 0;
  for (const PhotoResult& photo : calibration.photos)
    if (photo.photo.camera == c && photo.view)
      views += photo.used > 0, dropped += photo.corners - photo.used;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='{0:.1f} {0:.1f} {1:.1f} {2:.1f}' "
      "width='1000' font-family='sans-serif'>\n"
      "<rect x='{0:.1f}' y='{0:.1f}' width='{1:.1f}' height='{2:.1f}' fill='#fff'/>\n",
      -rim - 0.5, camera.width + 2 * rim, camera.height + 2 * rim + foot);
  svg += cells + views_of_camera(calibration, c, unit);
  svg += fmt::format(
      "<rect x='-0.5' y='-0.5' width='{}' height='{}' fill='none' stroke='#333' "
      "stroke-width='{:.2f}'/>\n",
      camera.width, camera.height, unit);
  const double y = camera.height + 28 * unit;
  svg += fmt::format(
      "<text x='0' y='{:.1f}' font-size='{:.1f}'>{}: {} x {} px, {} photos, off by {:.3f} px "
      "(RMS); "
      "corners in {:.0f} % of the cells</text>\n",
      y, 20 * unit, escaped(camera.name), camera.width, camera.height, views, calibration.rms_px[c],
      100 * share);
  svg += fmt::format(
      "<text x='0' y='{:.1f}' font-size='{:.1f}' fill='#555'>arrows: which way a corner is seen "
      "off the "
      "model, {:.0f} times as long; red: dropped ({}); shaded: no corner</text>\n",
      y + 26 * unit, 16 * unit, kEnlarged, dropped);
  return svg + "</svg>\n";
}

}  // namespace hookeye
