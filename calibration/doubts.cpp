// What photos of a board do not show.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/calibrate.h"

namespace hookeye {
namespace {

/// Of one camera: its views that count.
std::vector<const BoardView*> counting_views(const Calibration& calibration, size_t camera) {
  std::vector<const BoardView*> out;
  for (const BoardView& view : calibration.bundle.views)
    if (view.camera == camera && std::ranges::count(view.used, 1) > 0) out.push_back(&view);
  return out;
}

/// The largest angle between two boards as the camera sees them [degrees].
double tilt_range(const Bundle& bundle, const std::vector<const BoardView*>& views) {
  double least = 1.0;
  for (const BoardView* a : views)
    for (const BoardView* b : views)
      least =
          std::min(least, bundle.boards[a->board].R.col(2).dot(bundle.boards[b->board].R.col(2)));
  return std::acos(std::clamp(least, -1.0, 1.0)) * 180.0 / M_PI;
}

/// How far corners reach to the corners of the picture: the farthest from its middle in each
/// quarter, as a share of the half diagonal; the least of the four.
double reach(const Camera& camera, const std::vector<const BoardView*>& views) {
  const Eigen::Vector2d middle(0.5 * (camera.width - 1), 0.5 * (camera.height - 1));
  double farthest[4] = {0, 0, 0, 0};
  for (const BoardView* view : views)
    for (size_t i = 0; i < view->ids.size(); ++i) {
      if (!view->used[i]) continue;
      const Eigen::Vector2d off = view->pixels.col(static_cast<Eigen::Index>(i)) - middle;
      double& quarter = farthest[(off.x() > 0) + 2 * (off.y() > 0)];
      quarter = std::max(quarter, off.norm());
    }
  return *std::ranges::min_element(farthest) / middle.norm();
}

void doubt_camera(const Calibration& calibration, size_t c, std::vector<std::string>& out) {
  constexpr size_t kFewPoses = 8;
  constexpr double kFlat = 20.0, kMiddle = 0.6, kLarge = 1.0, kOpen = 0.01;
  const Camera& camera = calibration.bundle.cameras[c];
  const auto views = counting_views(calibration, c);
  if (views.size() < kFewPoses)
    out.push_back(fmt::format("{}: {} poses of the board; {} are the least that is usual",
                              camera.name, views.size(), kFewPoses));
  if (const double tilt = tilt_range(calibration.bundle, views); tilt < kFlat)
    out.push_back(fmt::format(
        "{}: all boards face alike, within {:.0f} degrees: focal length and distance are hardly "
        "told apart. Tilt the board by 20 to 40 degrees to all sides",
        camera.name, tilt));
  if (const double share = reach(camera, views); share < kMiddle)
    out.push_back(fmt::format(
        "{}: corners reach {:.0f} % of the way to a corner of the picture: beyond, the lens is "
        "extrapolated. Move the board out to all corners",
        camera.name, 100.0 * share));
  if (calibration.rms_px[c] > kLarge)
    out.push_back(fmt::format(
        "{}: corners are off by {:.2f} px (RMS), more than 1: a board that is not flat or not as "
        "told, blurred photos, a zoom or focus that changed, or a lens that needs --lens 8",
        camera.name, calibration.rms_px[c]));
  for (size_t i = 0; i < calibration.errors.parameters.size(); ++i) {
    const auto& parameter = calibration.errors.parameters[i];
    if (parameter.camera == c && parameter.name == "fx" &&
        calibration.errors.error(i) > kOpen * parameter.value)
      out.push_back(fmt::format("{}: the focal length is known to {:.1f} % alone", camera.name,
                                100.0 * calibration.errors.error(i) / parameter.value));
  }
}

/// Fewer than three boards tie a camera to the others.
void doubt_ties(const Calibration& calibration, std::vector<std::string>& out) {
  const auto& bundle = calibration.bundle;
  for (size_t c = 0; bundle.cameras.size() > 1 && c < bundle.cameras.size(); ++c) {
    size_t shared = 0;
    for (const BoardView* view : counting_views(calibration, c))
      shared += std::ranges::any_of(bundle.views, [&](const BoardView& other) {
        return other.board == view->board && other.camera != c &&
               std::ranges::count(other.used, 1) > 0;
      });
    if (shared < 3)
      out.push_back(fmt::format("{}: {} boards alone are seen by it and by another camera at once",
                                bundle.cameras[c].name, shared));
  }
}

}  // namespace

std::vector<std::string> doubts(const Calibration& calibration) {
  std::vector<std::string> out;
  for (size_t c = 0; c < calibration.bundle.cameras.size(); ++c) doubt_camera(calibration, c, out);
  doubt_ties(calibration, out);
  constexpr double kMany = 0.05;
  const double share = static_cast<double>(calibration.dropped) /
                       static_cast<double>(std::max<size_t>(calibration.corners, 1));
  if (share > kMany)
    out.push_back(fmt::format("{:.0f} % of the corners were dropped as wrong", 100.0 * share));
  const Board& board = calibration.bundle.board;
  if (board.dots() && board.diameter == 0.0)
    out.push_back(
        "the middle of a tilted dot is not where its centre is seen: give --diameter, and it is "
        "allowed for");
  return out;
}

}  // namespace hookeye
