#include "estimation/model/field_points.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "capture_io/field_start.h"
#include "meshing/extent.h"

namespace hookeye {

namespace {

/// What would bring the points onto the body.
std::string hint_at_unit(const BoundaryLocator& locator, const TetMesh& mesh,
                         const FieldSpec& field) {
  const auto farthest = [&](double factor) {
    double out = 0.0;
    SurfacePoint point;
    const Eigen::Index step = std::max<Eigen::Index>(1, field.X.cols() / 200);
    for (Eigen::Index k = 0; k < field.X.cols(); k += step)
      out = std::max(out, locator.locate(factor * field.X.col(k), &point));
    return out;
  };
  const double size = extent(field.X) / extent(mesh.X);
  for (const double factor : {1e-3, 1e3, 0.1, 10.0, 25.4, 1.0 / 25.4})
    // A crowd of points about an origin on the surface lies on it in any unit.
    if (factor * size > 0.1 && farthest(factor) <= field_tolerance(mesh, field))
      return fmt::format(
          "{:g} times their coordinates lie on it: tell the field's `unit` or `scale`", factor);
  // With `frame:` the origin hides that; how far the points reach does not know it.
  if (size > 3.0 || size < 0.03)
    return fmt::format(
        "the points reach over {:.3g}, the body over {:.3g}: tell the field's `unit` or `scale`",
        extent(field.X), extent(mesh.X));
  return "coordinates in the capture's frame (else tell `frame:`, whose z is x cross y) and of the "
         "body as it was given; `tolerance: LENGTH` allows for more";
}

}  // namespace

int start_index(const Scene& scene, const MeasuredSpec& measured) {
  const std::string& name = start_of(measured);
  if (name.empty()) return -1;
  const int out = scene.example_index(name);
  if (out < 0) throw std::logic_error("the example that a field starts from is not in the scene");
  return out;
}

TetMesh mesh_at(const TetMesh& mesh, const VectorXd& q) {
  TetMesh out = mesh;
  out.X = q.reshaped(3, q.size() / 3);
  return out;
}

FieldPoints field_points(const TetMesh& mesh, const FieldSpec& field, bool windows) {
  const BoundaryLocator locator(mesh);
  FieldPoints out;
  out.gap.resize(field.X.cols());
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index k = 0; k < field.X.cols(); ++k) {
    SurfacePoint point;
    out.gap[k] = locator.locate(field.X.col(k), &point);
    out.at.push_back(point);
    const VectorXd N = shape_functions(mesh.order, point.barycentric);
    for (Eigen::Index a = 0; a < N.size(); ++a)
      if (std::abs(N[a]) > 1e-14)
        entries.emplace_back(static_cast<int>(k), mesh.elements(a, point.element), N[a]);
  }
  out.N.resize(field.X.cols(), mesh.nodes());
  out.N.setFromTriplets(entries.begin(), entries.end());
  out.rest = (out.N * mesh.X.transpose()).transpose();
  if (field.strain)
    out.strain = std::make_shared<const StrainPoints>(strain_points(mesh, field, locator, windows));
  return out;
}

double field_tolerance(const TetMesh& mesh, const FieldSpec& field) {
  return field.tolerance > 0.0 ? field.tolerance : 0.02 * extent(mesh.X);
}

void check_fields(const Scene& scene, const ExampleSpec& example) {
  const TetMesh& mesh = scene.body->mesh;
  for (const MeasuredSpec& measured : example.measured) {
    if (!measured.field) continue;
    const FieldSpec& field = *measured.field;
    const BoundaryLocator locator(mesh);
    const bool loaded = !start_of(measured).empty();
    const double most = field_tolerance(mesh, field) + (loaded ? extent(mesh.X) : 0.0);
    double farthest = 0.0;
    Eigen::Index at = -1, off = 0;
    SurfacePoint point;
    for (Eigen::Index k = 0; k < field.X.cols(); ++k) {
      const double gap = locator.locate(field.X.col(k), &point);
      off += gap > most;
      if (gap > farthest) farthest = gap, at = k;
    }
    if (off == 0) {
      if (field.strain && !loaded) strain_tangents(mesh, field, locator);
      continue;
    }
    const Vector3d X = field.X.col(at);
    throw InputError(
        {field.told, field.lines[static_cast<size_t>(at)]},
        fmt::format(
            "the point ({:.4g}, {:.4g}, {:.4g}) lies {:.3g} {} off the body's surface, more "
            "than {:.3g} ({} of {} points do)",
            X.x(), X.y(), X.z(), farthest, scene.capture.units.length, most, off, field.X.cols()),
        hint_at_unit(locator, mesh, field));
  }
}

}  // namespace hookeye
