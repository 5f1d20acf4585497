#include "estimation/synth/synth_capture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "capture_io/camera_text.h"
#include "simulation/energy_term.h"

namespace hookeye::detail {

namespace {

/// Six digits are enough for what is told, and read well.
double rounded(double x) {
  const double value = std::stod(fmt::format("{:.6g}", x));
  return value == 0.0 ? 0.0 : value;
}
/// Components that rounding has left of a zero become one.
Vector3d rounded(const Vector3d& v) {
  const double dust = 1e-9 * v.cwiseAbs().maxCoeff();
  return v.unaryExpr([dust](double x) { return std::abs(x) <= dust ? 0.0 : rounded(x); });
}

std::string list(const Vector3d& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

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

std::string region_text(const RegionSpec& region, bool own) {
  const auto told = [own](const Vector3d& v) {
    return list(own ? v : Vector3d(rounded(v.x()), rounded(v.y()), rounded(v.z())));
  };
  if (const auto* box = std::get_if<RegionSpec::Box>(&region.shape))
    return fmt::format("box: [{}, {}]", told(box->low), told(box->high));
  if (const auto* ball = std::get_if<RegionSpec::Sphere>(&region.shape))
    return fmt::format("sphere: {{center: {}, radius: {}}}", told(ball->center), ball->radius);
  if (const auto* half = std::get_if<RegionSpec::Halfspace>(&region.shape))
    return fmt::format("halfspace: {{point: {}, normal: {}}}", told(half->point),
                       told(half->normal));
  return "faces: " + yaml_name(faces_file(region));
}

std::string regions_text(const Recipe& recipe, const SynthBody& body) {
  std::string out = "regions:\n";
  for (const RegionSpec& region : body.regions)
    fmt::format_to(std::back_inserter(out), "  {}: {{{}}}\n", yaml_name(region.name),
                   region_text(region, recipe.shape.own()));
  return out;
}

void write_supports(const ExampleRecipe& example, const SynthScale& scale, const Vector3d& centre,
                    std::string& out) {
  auto to = std::back_inserter(out);
  fmt::format_to(to, "    supports:\n    - {{region: base, fix: [x, y, z]}}\n");
  if (!example.moves()) return;
  const Vector3d move = rounded(scale.length * example.move.value_or(Vector3d::Zero()));
  fmt::format_to(to, "    - region: {}\n      rigid: {{move: {}", yaml_name(example.region),
                 list(move));
  if (example.rotate_degrees != 0.0)
    fmt::format_to(to, ", rotate: {{axis: {}, degrees: {}, center: {}}}",
                   list(rounded(example.axis)), example.rotate_degrees, list(rounded(centre)));
  out += "}\n";
}

void write_measured(const ExampleRecipe& example, const Vector3d& centre, const GripForce& measured,
                    double sigma, double moment_sigma, std::string& out) {
  if (!example.moves()) return;
  const std::string region = yaml_name(example.region);
  fmt::format_to(std::back_inserter(out),
                 "    measured:\n    - {{force_on: {}, value: {}, sigma: {}}}\n"
                 "    - {{moment_on: {}, about: {}, value: {}, sigma: {}}}\n",
                 region, list(rounded(measured.force)), rounded(sigma), region,
                 list(rounded(centre)), list(rounded(measured.moment)), rounded(moment_sigma));
}

std::string examples_text(const Recipe& recipe, const SynthBody& body, const CaptureText& options) {
  const SynthScale scale = scale_of(recipe, body);
  const auto cameras = make_cameras(recipe);
  std::string out = "examples:\n";
  auto to = std::back_inserter(out);
  for (size_t e = 0; e < recipe.examples.size(); ++e) {
    const ExampleRecipe& example = recipe.examples[e];
    const auto patch = body.patches.find(example.region);
    const Vector3d centre =
        patch == body.patches.end() ? Vector3d(Vector3d::Zero()) : patch->second.centre;
    fmt::format_to(to, "  {}:\n", yaml_name(example.name));
    if (example.validate) out += example.test ? "    use: test\n" : "    use: validate\n";
    write_supports(example, scale, centre, out);
    if (example.force)
      fmt::format_to(to, "    loads:\n    - {{region: {}, force: {}}}\n", yaml_name(example.region),
                     list(rounded(scale.force * *example.force)));
    if (example.moves())
      write_measured(
          example, centre, options.measured.empty() ? GripForce{} : options.measured[e],
          recipe.noise.force * force_unit(recipe, body, example),
          recipe.noise.moment * force_unit(recipe, body, example) * recipe.shape.height(), out);
    if (!options.photos) continue;
    out += "    photos:\n";
    for (const Camera& camera : cameras) {
      const std::string file = yaml_name(photo_name(recipe, example.name, camera.name));
      fmt::format_to(
          to, "      {}: {}\n", camera.name,
          recipe.photos.silhouette ? fmt::format("{{file: {}, kind: silhouette}}", file) : file);
    }
  }
  return out;
}

}  // namespace

std::string faces_file(const RegionSpec& region) { return region.name + "_faces.txt"; }

double force_unit(const Recipe& recipe, const SynthBody& body, const ExampleRecipe& example) {
  const std::string region = recipe.shape.own() ? example.region : "grip";
  return shear_modulus(recipe.material.truth) * body.patches.at(region).area;
}

SynthScale scale_of(const Recipe& recipe, const SynthBody& body) {
  if (recipe.shape.own()) return {};
  return {shear_modulus(recipe.material.truth) * body.patches.at("grip").area,
          recipe.shape.height()};
}

std::vector<Camera> make_cameras(const Recipe& recipe) {
  const CameraRecipe& rig = recipe.cameras;
  const double height = recipe.shape.height(), radian = EIGEN_PI / 180.0;
  Vector3d at(0.0, 0.0, rig.look_at * height);
  if (recipe.shape.own()) {
    const Matrix3Xd& X = recipe.shape.surface->X;
    at = rig.look_at_point.value_or(0.5 * (X.rowwise().minCoeff() + X.rowwise().maxCoeff()));
  }
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
    const std::string& kind = rig.projection[i % rig.projection.size()];
    camera.model = &camera_model(kind);
    // Parallel rays: as large a picture as the focal length makes at the rig's distance.
    camera.fx = camera.fy =
        camera.model->central() ? rig.focal : rig.focal / (rig.distance * height);
    if (camera.model->central())
      camera.distortion = rig.distortion, camera.vignetting = rig.vignetting;
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

namespace {

std::string sky_text(const LightSpec& light) {
  if (light.uneven.isZero(0.0)) return fmt::format("ambient: {}", light.ambient);
  return fmt::format("harmonics: [{}, {}]", rounded(light.ambient / even_by_harmonic),
                     fmt::join(light.uneven.data(), light.uneven.data() + kUnevenNumbers, ", "));
}

std::string light_and_noise_text(const Recipe& recipe) {
  const double strength = recipe.light.sun.norm();
  const Vector3d toward =
      strength > 0.0 ? Vector3d(recipe.light.sun / strength) : Vector3d::UnitZ();
  const NoiseModel noise = told_noise(recipe.noise);
  return fmt::format(
      "light:\n  {}\n  sun: {{toward: {}, strength: {}}}\n"
      "photos:\n  encoding: linear\n  background: black\n"
      "  noise: {{full_well: {}, read: {}}}\n",
      sky_text(recipe.light), list(toward), strength, noise.full_well, noise.read);
}

}  // namespace

std::string capture_text(const Recipe& recipe, const SynthBody& body, const CaptureText& options) {
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "hookeye: 1\ntitle: {}\nunits: {{length: {}, force: {}}}\n",
                 yaml_name(recipe.title), recipe.units.length, recipe.units.force);
  fmt::format_to(to, "body:\n  surface: surface.obj\n  mesh: {{edge: {}, order: {}}}\n",
                 recipe.edge, recipe.order);
  if (recipe.density > 0.0) fmt::format_to(to, "  density: {}\n", recipe.density);
  if (!recipe.photos.silhouette) out += "  texture: {image: albedo.png, encoding: linear}\n";
  const MaterialRecipe& material = recipe.material;
  fmt::format_to(to, "model:\n  material: {}\n  fit: [{}]\n",
                 law_text(options.truth ? material.truth : material.told),
                 fmt::join(material.fit, ", "));
  if (recipe.gravity) fmt::format_to(to, "  gravity: {}\n", list(*recipe.gravity));
  out += "cameras:\n";
  for (const Camera& camera : make_cameras(recipe)) out += camera_text(camera);
  if (!recipe.photos.silhouette) out += light_and_noise_text(recipe);
  out += regions_text(recipe, body);
  return out + examples_text(recipe, body, options);
}

}  // namespace hookeye::detail
