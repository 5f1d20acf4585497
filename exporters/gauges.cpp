// Virtual strain gauges and extensometers.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/input_error.h"
#include "exporters/seen_surface.h"
#include "meshing/boundary_face.h"

namespace hookeye {
namespace {

constexpr int kSamples = 51;  ///< along a line

void add(SurfaceStrain& sum, const SurfaceStrain& one, double weight) {
  sum.xx += weight * one.xx, sum.yy += weight * one.yy, sum.xy += weight * one.xy;
}

/// The point of an element's boundary face at weights L of its corners.
SurfacePoint point_on_face(const TetMesh& mesh, int face, const Vector3d& L) {
  SurfacePoint out;
  out.element = mesh.boundary_element[static_cast<size_t>(face)];
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 4; ++c)
      if (mesh.elements(c, out.element) == mesh.boundary(k, face)) out.barycentric[c] = L[k];
  return out;
}

/// An axis of the body that lies well in the region: x, else y.
Vector3d axis_for(const Region& region, const SeenOptions& options) {
  constexpr double kUpright = 0.8;  // cosine
  if (options.along) return options.along->normalized();
  return std::abs(region.normal.x()) < kUpright ? Vector3d::UnitX() : Vector3d::UnitY();
}

/// Shares of the boundary's faces that belong to a region, by element and the corner opposite.
class Membership {
 public:
  Membership(const TetMesh& mesh, const Region& region) : boundary_(mesh) {
    for (const auto& [face, share] : region.faces) {
      const SurfacePoint on = point_on_face(mesh, face, Vector3d::Ones());
      shares_[{on.element, boundary_.opposite(on)}] = share;
    }
  }
  bool has(const SurfacePoint& point) const {
    const auto found = shares_.find({point.element, boundary_.opposite(point)});
    return found != shares_.end() && found->second > 0.5;
  }

 private:
  BoundaryFaces boundary_;
  std::map<std::pair<int, int>, double> shares_;
};

Gauge gauge_of(const Body& body, const VectorXd& q, const Region& region,
               const SeenOptions& options, const std::vector<SeenPoints>& views) {
  const TetMesh& mesh = body.mesh;
  Gauge out;
  out.name = region.name, out.along = axis_for(region, options);
  double area = 0.0;
  for (const auto& [face, share] : region.faces) {
    const detail::BoundaryFace shape(mesh, face);
    for (const detail::Sample& sample : detail::whole_rule()) {
      const Vector3d normal = shape.area_vector(sample.L);
      const double weight = share * sample.weight * normal.norm();
      const Tangents T = tangents_of(normal.normalized(), out.along);
      add(out.strain, strain_of(gradient_at(mesh, q, point_on_face(mesh, face, sample.L)) * T),
          weight);
      area += weight;
    }
  }
  if (area > 0.0) {
    const SurfaceStrain sum = std::exchange(out.strain, {});
    add(out.strain, sum, 1.0 / area);
  }
  const Membership membership(mesh, region);
  SurfaceStrain seen, model;
  for (const SeenPoints& view : views)
    for (int i = 0; i < view.size() && view.from.empty(); ++i) {
      const auto k = static_cast<size_t>(i);
      if (!view.strain_seen[k] || !membership.has(view.points[k])) continue;
      const Tangents& T = view.tangents[k];
      const Tangents own = tangents_of(Vector3d(T.col(0)).cross(Vector3d(T.col(1))), out.along);
      const Eigen::Matrix2d turn = T.transpose() * own;
      add(seen, turned(*view.strain_seen[k], turn), 1.0);
      add(model, turned(view.strain[k], turn), 1.0);
      ++out.points;
    }
  if (out.points > 0) {
    out.seen.emplace(), out.differ.emplace();
    add(*out.seen, seen, 1.0 / out.points), add(*out.differ, model, 1.0 / out.points);
  }
  return out;
}

/// What the photos add to the model's displacement at the nearest of their points, at most 1.5
/// spacings away.
std::optional<Vector3d> apart_at(const std::vector<SeenPoints>& views, const Vector3d& X) {
  std::optional<Vector3d> out;
  double nearest = 1.5;
  for (const SeenPoints& view : views)
    for (int i = 0; i < view.size() && view.from.empty(); ++i) {
      const double distance = (view.X.col(i) - X).norm() / std::max(view.spacing, 1e-300);
      if (!view.has_apart(i) || distance >= nearest) continue;
      nearest = distance, out = view.apart.col(i);
    }
  return out;
}

Line line_of(const TetMesh& mesh, const VectorXd& q, const BoundaryLocator& locator,
             const std::array<Vector3d, 2>& told, const std::vector<SeenPoints>& views) {
  Line out;
  const BoundaryFaces faces(mesh);
  out.X.resize(3, kSamples), out.u.resize(3, kSamples);
  for (int i = 0; i < kSamples; ++i) {
    SurfacePoint point;
    const double share = static_cast<double>(i) / (kSamples - 1);
    locator.locate((1.0 - share) * told[0] + share * told[1], &point);
    const VectorXd N = shape_functions(mesh.order, point.barycentric);
    Vector3d X = Vector3d::Zero();
    for (Eigen::Index a = 0; a < N.size(); ++a)
      X += N[a] * mesh.X.col(mesh.elements(a, point.element));
    out.X.col(i) = X, out.u.col(i) = displacement_at(mesh, q, point);
    const Tangents T = tangents_of(faces.normal(point), told[1] - told[0]);
    out.strain.push_back(strain_of(gradient_at(mesh, q, point) * T));
  }
  const Vector3d a = out.X.col(0), b = out.X.rightCols<1>();
  const Vector3d ends = b + out.u.rightCols<1>() - a - out.u.col(0);
  out.ends = {a, b}, out.rest = (b - a).norm(), out.length = ends.norm();
  const auto at_a = apart_at(views, a), at_b = apart_at(views, b);
  if (at_a && at_b) out.seen = (ends + *at_b - *at_a).norm();
  return out;
}

}  // namespace

void add_gauges(const Model& model, const VectorXd& q, const SeenOptions& options, SeenCase& out) {
  const Body& body = *model.scene->body;
  const auto& regions = body.regions.all();
  for (const std::string& name : options.gauges)
    if (!regions.contains(name)) {
      std::string known;
      for (const auto& [own, region] : regions) known += (known.empty() ? "" : ", ") + own;
      throw InputError({"--gauge"}, fmt::format("the capture has no region '{}'", name),
                       known.empty() ? "regions are told in capture.yaml" : "one of: " + known);
    }
  for (const auto& [name, region] : regions)
    if (options.gauges.empty() || std::ranges::find(options.gauges, name) != options.gauges.end())
      out.gauges.push_back(gauge_of(body, q, region, options, out.views));
  const BoundaryLocator locator(body.mesh);
  for (const auto& ends : options.lines) {
    out.lines.push_back(line_of(body.mesh, q, locator, ends, out.views));
    out.lines.back().name = fmt::format("line{}", out.lines.size());
  }
}

}  // namespace hookeye
