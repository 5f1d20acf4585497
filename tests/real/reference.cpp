#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>

#include "real/captures.h"

namespace hookeye::real {

namespace {

/// One camera from the side and a little above, at the block and what it becomes.
std::string camera_text() {
  const Eigen::Vector3d at(60, 15, 8), forward = Eigen::Vector3d(0.25, 0.9, -0.3).normalized();
  Eigen::Matrix3d R;
  R.row(2) = forward;
  R.row(0) = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  R.row(1) = forward.cross(Eigen::Vector3d(R.row(0)));
  const Eigen::Vector3d t = -R * (at - 600.0 * forward);
  std::string rows;
  for (int i = 0; i < 3; ++i)
    rows += fmt::format("{}[{:.15g}, {:.15g}, {:.15g}]", i ? ", " : "", R(i, 0), R(i, 1), R(i, 2));
  return fmt::format(
      "cameras:\n  side:\n    size: [420, 360]\n"
      "    intrinsics: {{fx: 1500, fy: 1500, cx: 209.5, cy: 179.5}}\n"
      "    pose: {{rotation: [{}], translation: [{:.12g}, {:.12g}, {:.12g}]}}\n",
      rows, t.x(), t.y(), t.z());
}

}  // namespace

void write_reference(const fs::path& data, const fs::path& capture, const std::string& deck) {
  fs::create_directories(capture);
  fs::copy_file(data / (deck + ".inp"), capture / "block.inp",
                fs::copy_options::overwrite_existing);
  const bool bent = deck.back() == 'A';
  // The data's README: stretched by 30 % along an arc of 45 degrees, or a heavy cantilever.
  const double phi = M_PI / 4, r = 130 / phi;
  std::string text = fmt::format(
      "hookeye: 1\ntitle: block {}\nunits: {{length: mm, force: N}}\n"
      "body: {{volume: block.inp, density: 1.07e-9, texture: {{uniform: 0.8}}, shading: flat}}\n"
      "model:\n  material: {{law: neo-hookean, mu: {}, kappa: {:.15g}}}\n",
      deck, bent ? 0.1 : 0.03, bent ? 7.0 / 15.0 : 0.14);
  if (!bent) text += "  gravity: [0, 0, -9810]\n";
  text += "light: {ambient: 0.35, sun: {toward: [-0.3, -0.6, 0.8], strength: 0.6}}\n";
  text += camera_text();
  text +=
      "regions:\n  left: {halfspace: {point: [1e-6, 0, 0], normal: [-1, 0, 0]}}\n"
      "  right: {halfspace: {point: [99.999999, 0, 0], normal: [1, 0, 0]}}\n"
      "examples:\n  loaded:\n    supports:\n      - {region: left, fix: [x, y, z]}\n";
  if (bent)
    text += fmt::format(
        "      - {{region: right, rigid: {{rotate: {{axis: [0, -1, 0], degrees: 45, center: [100, "
        "15, "
        "10]}}, move: [{:.15g}, 0, {:.15g}]}}}}\n",
        r * std::sin(phi) - 100.0, r * (1.0 - std::cos(phi)));
  std::ofstream(capture / "capture.yaml") << text;
}

}  // namespace hookeye::real
