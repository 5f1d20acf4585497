#include "estimation/model/doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <variant>

#include "capture_io/yaml_place.h"
#include "meshing/extent.h"

namespace hookeye {

namespace {

using Sentences = std::vector<std::string>;

Vector3d displacement(const SupportSpec& support, const Vector3d& X) {
  Vector3d u = Vector3d::Constant(std::nan(""));
  if (support.kind == SupportSpec::Kind::rigid) return support.rigid.apply(X) - X;
  if (support.kind == SupportSpec::Kind::components)
    for (int i = 0; i < 3; ++i)
      if (support.displacement[i]) u[i] = *support.displacement[i];
  return u;  // NaN: free, or fitted
}

/// Two supports tell one node different displacements: simulation keeps the later one.
void compare_supports(const Scene& scene, const ExampleSpec& example, Sentences* out) {
  const double same = 1e-9 * extent(scene.body->mesh.X);
  for (size_t b = 0; b < example.supports.size(); ++b)
    for (size_t a = 0; a < b; ++a) {
      const SupportSpec &first = example.supports[a], &later = example.supports[b];
      const Region& region = scene.body->regions.at(first.region);
      const Region& other = scene.body->regions.at(later.region);
      int nodes = 0;
      for (int n : region.nodes) {
        if (!std::binary_search(other.nodes.begin(), other.nodes.end(), n)) continue;
        const Vector3d X = scene.body->mesh.X.col(n);
        const Vector3d apart = displacement(first, X) - displacement(later, X);
        nodes += (apart.array().abs() > same).any();  // false for NaN
      }
      if (nodes > 0)
        out->push_back(fmt::format(
            "example {}: the supports `{}` and `{}` share {} nodes and move them differently; `{}` "
            "has them",
            example.name, first.region, later.region, nodes, later.region));
    }
}

void look_at_measurements(const Scene& scene, const ExampleSpec& example, Sentences* out) {
  std::set<int> held;
  for (const SupportSpec& support : example.supports) {
    const auto& nodes = scene.body->regions.at(support.region).nodes;
    held.insert(nodes.begin(), nodes.end());
  }
  for (const MeasuredSpec& measured : example.measured) {
    if (measured.kind == MeasuredSpec::Kind::position_of) {
      SurfacePoint nearest;
      const double off = locate_on_boundary(scene.body->mesh, measured.point, &nearest);
      if (off > 0.01 * extent(scene.body->mesh.X))
        out->push_back(fmt::format(
            "example {}: the measured point ({:.4g}, {:.4g}, {:.4g}) lies {:.3g} {} off the body "
            "at rest; the nearest point of its surface is taken",
            example.name, measured.point.x(), measured.point.y(), measured.point.z(), off,
            scene.capture.units.length));
      continue;
    }
    if (!is_reaction(measured)) continue;
    const auto& nodes = scene.body->regions.at(measured.region).nodes;
    if (std::none_of(nodes.begin(), nodes.end(), [&](int n) { return held.count(n) > 0; }))
      out->push_back(fmt::format(
          "example {}: {} is measured on `{}`, which no support holds there: the model's is zero",
          example.name, measured.kind == MeasuredSpec::Kind::force_on ? "a force" : "a moment",
          measured.region));
  }
}

/// "" where the picture meets the rectangle about the body at rest, else where that lies. Loads
/// rarely bring the body into a picture that it was far from.
std::string beside_the_picture(const Camera& camera, const Matrix3Xd& X) {
  Vector2d low(1e30, 1e30), high = -low;
  for (Eigen::Index v = 0; v < X.cols(); ++v) {
    const Vector2d px = camera.project(X.col(v));
    if (!px.allFinite()) continue;  // behind the camera
    low = low.cwiseMin(px), high = high.cwiseMax(px);
  }
  if (!(low.x() <= high.x())) return "which lies behind it";
  if (high.x() > -0.5 && high.y() > -0.5 && low.x() < camera.width - 0.5 &&
      low.y() < camera.height - 0.5)
    return "";
  // Points next to the camera's plane are thrown anywhere.
  if (std::max({-low.x(), -low.y(), high.x(), high.y()}) >
      100.0 * std::max(camera.width, camera.height))
    return fmt::format("which it would show far beside its {} x {} px", camera.width,
                       camera.height);
  return fmt::format(
      "which it would show at x from {:.0f} to {:.0f}, y from {:.0f} to {:.0f} of {} x {} px",
      low.x(), high.x(), low.y(), high.y(), camera.width, camera.height);
}

/// Where the capture tells a camera; "" of one that comes from no file.
std::string told_at(const Capture& capture, const Camera& camera) {
  if (!std::filesystem::is_regular_file(capture.file)) return "";
  const YamlPlaces places(capture.file, capture.file.string());
  return places.of({"cameras", camera.name}).str() + ": ";
}

void look_at_photos(const Scene& scene, Sentences* out) {
  std::set<std::string> used;
  for (size_t e = 0; e < scene.photos.size(); ++e)
    for (size_t k = 0; k < scene.photos[e].size(); ++k) {
      const Photo& photo = scene.photos[e][k];
      used.insert(photo.camera);
      if (std::find(photo.valid->begin(), photo.valid->end(), 1) == photo.valid->end())
        out->push_back(fmt::format("example {}: no pixel of the photo by camera {} counts",
                                   scene.capture.examples[e].name, photo.camera));
    }
  if (scene.capture.body.fit_placement) return;
  for (const Camera& as_read : scene.capture.cameras) {
    if (!used.count(as_read.name)) continue;
    const int halvings = scene.halvings_of(as_read.name);
    Camera camera = as_read.resized(std::exp2(halvings));  // users know the photo that they took
    camera.width <<= halvings, camera.height <<= halvings;
    const std::string where = beside_the_picture(camera, scene.body->surface.mesh.X);
    if (where.empty()) continue;
    out->push_back(fmt::format(
        "{}camera {} looks past the body at rest, {}: check its pose, its {}, its units and the "
        "body's; where mesh and cameras are in two frames, `hookeye place` finds where the body "
        "lies",
        told_at(scene.capture, camera), camera.name, where,
        camera.model->central() ? "focal length" : "scale (px per length)"));
  }
}

/// Stretch along x at constant volume from which the energy falls again (above 1: a pull, below: a
/// push), 0 where it does not up to five times or a fifth of the length.
double stretch_of_falling(const EnergyTerm& law, bool pull) {
  const double rounding = 1e-12 * std::abs(law.psi(Vector3d(1.5, 0.8, 0.8).asDiagonal()));
  double before = 0.0;
  for (int i = 1; i <= 200; ++i) {
    const double stretch = std::pow(5.0, (pull ? 1.0 : -1.0) * i / 200.0);
    const Vector3d along(stretch, 1.0 / std::sqrt(stretch), 1.0 / std::sqrt(stretch));
    const double now = law.psi(along.asDiagonal());
    if (now < before - rounding) return stretch;
    before = now;
  }
  return 0.0;
}

void look_at_material(const MaterialSpec& spec, Sentences* out) {
  const auto law = make_law(spec);
  const std::string of = spec.region.empty() ? "material" : "material " + spec.region;
  for (const bool pull : {true, false})
    if (const double at = stretch_of_falling(*law, pull); at > 0.0)
      out->push_back(fmt::format(
          "{}: {}: the energy of this {} falls again from a stretch of {:.3g} on (at constant "
          "volume): there the body has no equilibrium that lasts",
          spec.place.str(), of, spec.law, at));
  const auto told = spec.parameters.find("frame");
  if (told == spec.parameters.end() || told->second.numbers.size() != 9) return;
  const Matrix3d axes = Eigen::Map<const Matrix3d>(told->second.numbers.data());
  const double off = (axes.transpose() * axes - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > 1e-6)
    out->push_back(fmt::format(
        "{}: the axes of `frame` are orthonormal to {:.1g} only; the nearest ones that are so are "
        "taken",
        of, off));
}

/// Regions by shape that hold nodes and no face: what acts there acts on next to nothing.
void look_at_regions(const Scene& scene, Sentences* out) {
  std::map<std::string, std::string> used;  // and by what
  for (const ExampleSpec& example : scene.capture.examples) {
    for (const SupportSpec& one : example.supports) used.emplace(one.region, "a support");
    for (const LoadSpec& one : example.loads) used.emplace(one.region, "a load");
  }
  for (const RegionSpec& spec : scene.capture.regions) {
    const auto by = used.find(spec.name);
    const bool drawn = std::holds_alternative<RegionSpec::Box>(spec.shape) ||
                       std::holds_alternative<RegionSpec::Halfspace>(spec.shape) ||
                       std::holds_alternative<RegionSpec::Sphere>(spec.shape);
    if (by == used.end() || !drawn) continue;
    const Region& region = scene.body->regions.at(spec.name);
    if (region.area > 0.0) continue;
    out->push_back(fmt::format(
        "region `{}` of {} has {} node{} and no area: no face of the surface lies in it. A shape "
        "thinner than a hundredth of the body means a plane; where the body's end is tilted, lay "
        "one along it: `halfspace: {{point: [x, y, z], normal: [x, y, z]}}`",
        spec.name, by->second, region.nodes.size(), region.nodes.size() == 1 ? "" : "s"));
  }
}

}  // namespace

Sentences doubts(const Scene& scene) {
  Sentences out;
  for (const MaterialSpec& material : scene.capture.materials) look_at_material(material, &out);
  look_at_regions(scene, &out);
  for (const ExampleSpec& example : scene.capture.examples) {
    compare_supports(scene, example, &out);
    look_at_measurements(scene, example, &out);
  }
  look_at_photos(scene, &out);
  return out;
}

}  // namespace hookeye
