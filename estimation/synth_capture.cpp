#include "estimation/synth_capture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "simulation/energy_term.h"

namespace hookeye::detail {

namespace {

/// Six digits are enough for what is told, and read well.
double rounded(double x) {
  const double value = std::stod(fmt::format("{:.6g}", x));
  return value == 0.0 ? 0.0 : value;
}
Vector3d rounded(const Vector3d& v) { return v.unaryExpr([](double x) { return rounded(x); }); }

std::string list(const Vector3d& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }
std::string quoted(const std::string& text) { return nlohmann::json(text).dump(); }

std::string law_text(const MaterialSpec& material) {
  std::string out = "{law: " + material.law;
  for (const auto& [name, value] : material.parameters)
    out += value.numbers.size() == 1
               ? fmt::format(", {}: {}", name, value.numbers[0])
               : fmt::format(", {}: [{}]", name, fmt::join(value.numbers, ", "));
  return out + "}";
}

double shear_modulus(const MaterialSpec& material) {
  return make_law(material)->dP_dF(Eigen::Matrix3d::Identity())(3, 3);
}

/// Area and centroid of some triangles.
std::pair<double, Vector3d> patch(const SurfaceMesh& surface, const std::vector<int>& triangles) {
  double area = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (const int t : triangles) {
    const Vector3d a = surface.X.col(surface.triangles[t][0]);
    const Vector3d b = surface.X.col(surface.triangles[t][1]);
    const Vector3d c = surface.X.col(surface.triangles[t][2]);
    const double part = 0.5 * (b - a).cross(c - a).norm();
    area += part;
    moment += part * (a + b + c) / 3.0;
  }
  return {area, area > 0.0 ? Vector3d(moment / area) : moment};
}

std::string camera_text(const Camera& camera) {
  std::string rows;
  for (int i = 0; i < 3; ++i)
    rows += (i ? ", " : "") + list(camera.R.row(i).transpose());
  return fmt::format(
      "  {}:\n    size: [{}, {}]\n    projection: perspective\n"
      "    intrinsics: {{fx: {}, fy: {}, cx: {}, cy: {}}}\n"
      "    pose:\n      rotation: [{}]\n      translation: {}\n",
      camera.name, camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, rows,
      list(camera.t));
}

std::string regions_text(const SynthBody& body, const SynthScale& scale) {
  const Vector3d low = body.surface.X.rowwise().minCoeff(), high = body.surface.X.rowwise().maxCoeff();
  const double margin = 0.1 * scale.height, thin = 0.0005 * scale.height;
  return fmt::format(
      "regions:\n  base:\n    box: [[{}, {}, {}], [{}, {}, {}]]\n"
      "  grip: {{faces: grip_faces.txt}}\n  side: {{faces: side_faces.txt}}\n",
      rounded(low.x() - margin), rounded(low.y() - margin), rounded(-thin),
      rounded(high.x() + margin), rounded(high.y() + margin), rounded(thin));
}

void write_supports(const ExampleRecipe& example, const SynthScale& scale, std::string& out) {
  auto to = std::back_inserter(out);
  fmt::format_to(to, "    supports:\n    - {{region: base, fix: [x, y, z]}}\n");
  if (!example.moves()) return;
  const Vector3d move = rounded(scale.height * example.move.value_or(Vector3d::Zero()));
  fmt::format_to(to, "    - region: {}\n      rigid: {{move: {}", example.region, list(move));
  if (example.rotate_degrees != 0.0)
    fmt::format_to(to, ", rotate: {{axis: {}, degrees: {}, center: {}}}",
                   list(rounded(example.axis)), example.rotate_degrees,
                   list(rounded(scale.centre(example.region))));
  out += "}\n";
}

void write_measured(const Recipe& recipe, const ExampleRecipe& example, const SynthScale& scale,
                    const GripForce& measured, std::string& out) {
  if (!example.moves()) return;
  fmt::format_to(std::back_inserter(out),
                 "    measured:\n    - {{force_on: {}, value: {}, sigma: {}}}\n"
                 "    - {{moment_on: {}, about: {}, value: {}, sigma: {}}}\n",
                 example.region, list(rounded(measured.force)),
                 rounded(recipe.noise.force * scale.force), example.region,
                 list(rounded(scale.centre(example.region))), list(rounded(measured.moment)),
                 rounded(recipe.noise.moment * scale.force * scale.height));
}

std::string examples_text(const Recipe& recipe, const SynthBody& body, const CaptureText& options) {
  const SynthScale scale = scale_of(recipe, body);
  const auto cameras = make_cameras(recipe);
  std::string out = "examples:\n";
  auto to = std::back_inserter(out);
  for (size_t e = 0; e < recipe.examples.size(); ++e) {
    const ExampleRecipe& example = recipe.examples[e];
    fmt::format_to(to, "  {}:\n", quoted(example.name));
    if (example.validate) out += "    use: validate\n";
    write_supports(example, scale, out);
    if (example.force)
      fmt::format_to(to, "    loads:\n    - {{region: {}, force: {}}}\n", example.region,
                     list(rounded(scale.force * *example.force)));
    write_measured(recipe, example, scale,
                   options.measured.empty() ? GripForce{} : options.measured[e], out);
    if (!options.photos) continue;
    out += "    photos:\n";
    for (const Camera& camera : cameras)
      fmt::format_to(to, "      {}: {}\n", camera.name,
                     quoted(photo_name(recipe, example.name, camera.name)));
  }
  return out;
}

}  // namespace

SynthScale scale_of(const Recipe& recipe, const SynthBody& body) {
  SynthScale scale;
  const auto [area, centre] = patch(body.surface, body.grip);
  scale.force = shear_modulus(recipe.material.truth) * area;
  scale.height = recipe.shape.size.z();
  scale.grip = centre;
  scale.side = patch(body.surface, body.side).second;
  return scale;
}

std::vector<Camera> make_cameras(const Recipe& recipe) {
  const CameraRecipe& rig = recipe.cameras;
  const double height = recipe.shape.size.z(), radian = EIGEN_PI / 180.0;
  const Vector3d at(0.0, 0.0, rig.look_at * height);
  std::vector<Camera> cameras;
  for (int i = 0; i < rig.count; ++i) {
    const double azimuth = (rig.azimuth + i * rig.spread) * radian;
    const double elevation = rig.elevation * radian;
    const Vector3d from(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    Camera camera;
    camera.name = fmt::format("cam{}", i);
    camera.width = rig.width;
    camera.height = rig.height;
    camera.fx = camera.fy = rig.focal;
    camera.cx = 0.5 * (rig.width - 1);
    camera.cy = 0.5 * (rig.height - 1);
    const Vector3d forward = -from;
    const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
    camera.R.row(0) = right;
    camera.R.row(1) = forward.cross(right);
    camera.R.row(2) = forward;
    camera.t = -camera.R * (at + rig.distance * height * from);
    cameras.push_back(camera);
  }
  return cameras;
}

NoiseModel told_noise(const NoiseRecipe& noise) {
  // a level's rounding error is uniform: variance step^2/12
  const double step = 1.0 / ((1 << noise.bits) - 1);
  NoiseModel model;
  model.full_well = noise.full_well;
  model.read = rounded(std::sqrt(noise.read * noise.read + step * step / 12.0));
  return model;
}

std::string photo_name(const Recipe& recipe, const std::string& example,
                       const std::string& camera) {
  return fmt::format("photos/{}_{}.{}", example, camera, recipe.noise.bits == 8 ? "png" : "tif");
}

std::string capture_text(const Recipe& recipe, const SynthBody& body, const CaptureText& options) {
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "hookeye: 1\ntitle: {}\nunits: {{length: {}, force: {}}}\n",
                 quoted(recipe.title), recipe.units.length, recipe.units.force);
  fmt::format_to(to, "body:\n  surface: surface.obj\n  mesh: {{edge: {}, order: {}}}\n",
                 recipe.edge, recipe.order);
  if (recipe.density > 0.0) fmt::format_to(to, "  density: {}\n", recipe.density);
  fmt::format_to(to, "  texture: {{image: albedo.png, encoding: linear}}\n");
  const MaterialRecipe& material = recipe.material;
  fmt::format_to(to, "model:\n  material: {}\n  fit: [{}]\n",
                 law_text(options.truth ? material.truth : material.told),
                 fmt::join(material.fit, ", "));
  out += "cameras:\n";
  for (const Camera& camera : make_cameras(recipe)) out += camera_text(camera);
  const double strength = recipe.light.sun.norm();
  const Vector3d toward = strength > 0.0 ? Vector3d(recipe.light.sun / strength) : Vector3d::UnitZ();
  fmt::format_to(to, "light:\n  ambient: {}\n  sun: {{toward: {}, strength: {}}}\n",
                 recipe.light.ambient, list(toward), strength);
  const NoiseModel noise = told_noise(recipe.noise);
  fmt::format_to(to,
                 "photos:\n  encoding: linear\n  background: black\n"
                 "  noise: {{full_well: {}, read: {}}}\n",
                 noise.full_well, noise.read);
  out += regions_text(body, scale_of(recipe, body));
  return out + examples_text(recipe, body, options);
}

}  // namespace hookeye::detail
