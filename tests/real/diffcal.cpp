#include <fmt/format.h>

#include <Eigen/Core>
#include <fstream>
#include <nlohmann/json.hpp>

#include "real/captures.h"
#include "real/silhouette.h"

namespace hookeye::real {

namespace {

using nlohmann::json;

Eigen::Matrix3d matrix_of(const json& rows) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = rows[i][j];
  return m;
}

/// One camera, lengths in cm, x in the mesh's own axes: X_world = X + (-8.75, -3.25, -2.25) cm
/// (the authors' object_transform).
std::string camera_text(const json& intrinsics, const json& pose) {
  const Eigen::Matrix3d R = matrix_of(pose["R"]);
  const Eigen::Vector3d t_m(pose["t"][0], pose["t"][1], pose["t"][2]);
  const Eigen::Vector3d t = R * Eigen::Vector3d(-8.75, -3.25, -2.25) + 100.0 * t_m;
  std::string rows;
  for (int i = 0; i < 3; ++i)
    rows += fmt::format("{}[{:.15g}, {:.15g}, {:.15g}]", i ? ", " : "", R(i, 0), R(i, 1), R(i, 2));
  return fmt::format(
      "  rgb:\n    size: [1280, 720]\n"
      "    intrinsics: {{fx: {}, fy: {}, cx: {}, cy: {}}}\n"
      "    pose: {{rotation: [{}], translation: [{:.10g}, {:.10g}, {:.10g}]}}\n",
      intrinsics["fx"].get<double>(), intrinsics["fy"].get<double>(),
      intrinsics["cx"].get<double>(), intrinsics["cy"].get<double>(), rows, t.x(), t.y(), t.z());
}

/// White where pixels count: everything left of the clamp's edge, behind which the bar vanishes.
void write_mask(const fs::path& file, int clamp_edge_px) {
  Image mask{1280, 720, 1, std::vector<float>(1280 * 720, 0.0f)};
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < clamp_edge_px; ++x) mask.at(x, y) = 1.0f;
  write_image(file, mask);
}

}  // namespace

void write_diffcal(const fs::path& data, const fs::path& capture, const Silicone& silicone) {
  fs::create_directories(capture / "photos");
  const bool red = silicone.material == 'e';
  const std::string experiment = fmt::format("h_{}_c", silicone.material);
  const fs::path photo = data / "rgb" / fmt::format("{}_frame{}.png", experiment, red ? 31 : 20);
  const Image stored = stored_values(photo);
  // Ecoflex is red, Mold Star blue-green, nothing near them is; their faces turned away from the
  // light are dark, but of the same colour. Red over the next channel is 1 behind the bar and 2.5
  // to 6 on it, 1.9 where the sky glances off it, and least often 1.5.
  const Image inside = silhouette(stored, 560, red ? 380 : 450, [&](const float* p) {
    return red ? p[0] > 0.2f && p[0] > 1.5f * std::max(p[1], p[2])
               : p[2] > 0.12f && p[0] < 0.4f * std::min(p[1], p[2]);
  });
  write_image(capture / "photos" / "silhouette.png", inside);
  write_mask(capture / "photos" / "mask.png", red ? 690 : 732);
  fs::copy_file(data / "mesh" / "cantilever_f640_v322.obj", capture / "cantilever.obj",
                fs::copy_options::overwrite_existing);
  const json cameras = json::parse(std::ifstream(data / "cameras.json"));
  std::string text = fmt::format(
      "hookeye: 1\ntitle: silicone bar {} under its weight\n"
      "units: {{length: cm, force: N}}\n"
      "body:\n  surface: cantilever.obj\n  mesh: {{edge: {}, order: 2}}\n"
      // N s^2/cm^4; a weight fixes only stiffness over density
      "  density: {:.6g}\n{}"
      // Poisson's ratio 0.49
      "model:\n  material: {{law: neo-hookean, mu: {:.6g}, kappa_over_mu: 49.67}}\n  fit: [mu]\n"
      "  gravity: [0, -980.665, 0]\n",
      experiment, silicone.edge, 1e-8 * silicone.density_si,
      silicone.fit_placement ? "  placement: fit\n" : "", 1e-4 * silicone.start_mu_si);
  text += "cameras:\n" + camera_text(cameras["rgb_intrinsics_RECOVERED"],
                                     cameras["experiments"][experiment]["world_to_rgb_REFINED"]);
  text +=
      "regions:\n  clamp: {halfspace: {point: [7, 0, 0], normal: [1, 0, 0]}}\n"
      "examples:\n  hang:\n    supports: [{region: clamp, fix: [x, y, z]}]\n    photos:\n"
      "      rgb: {file: photos/silhouette.png, kind: silhouette, mask: photos/mask.png}\n";
  std::ofstream(capture / "capture.yaml") << text;
}

}  // namespace hookeye::real
