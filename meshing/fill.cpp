// A closed surface filled with tetrahedra: what TetGen is asked, how often, and what it may answer.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "meshing/detail.h"
#include "meshing/skin.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace {

using detail::Subdivided;
using detail::TetGenTask;

double area(const SurfaceMesh& s) {
  double sum = 0.0;
  for (const auto& t : s.triangles) {
    const Vector3d a = s.X.col(t[0]), b = s.X.col(t[1]), c = s.X.col(t[2]);
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

/// Whether the tetrahedra have volume, all of them, and together that of the skin.
bool fills(const TetMesh& mesh, const SurfaceMesh& skin) {
  double sum = 0.0;
  for (int e = 0; e < mesh.size(); ++e) {
    const auto x = [&](int k) { return Vector3d(mesh.X.col(mesh.elements(k, e))); };
    const Vector3d a = x(1) - x(0), b = x(2) - x(0), c = x(3) - x(0);
    const double six_volume = a.cross(b).dot(c);
    if (six_volume <= 1e-12 * std::pow(std::max({a.norm(), b.norm(), c.norm()}), 3)) return false;
    sum += six_volume;
  }
  const double wanted = detail::six_volume(skin);
  return std::abs(sum - wanted) <= 1e-6 * wanted;
}

/// About how many tetrahedra of an edge, or of the surface's own triangles where they are finer.
double expected(const SurfaceMesh& surface, double edge) {
  const double regular = edge * edge * edge / std::sqrt(2.0);  // six volumes of one
  return detail::six_volume(surface) / regular +
         5.0 * static_cast<double>(surface.triangles.size());
}

/// TetGen gives up on about one body in a hundred because of the way in which points happen to be
/// rounded; turned a little it takes the same one.
std::optional<TetMesh> filled(const Subdivided& skin, TetGenTask task, bool keep_surface) {
  if (skin.mesh.triangles.empty()) return {};
  task.keep_surface = keep_surface;
  for (const auto& [angle, about] :
       {std::pair{0.0, Vector3d(1, 0, 0)}, {0.7, Vector3d(1, 2, 3)}, {1.1, Vector3d(-3, 1, 2)}}) {
    task.turn = Eigen::AngleAxisd(angle, about.normalized()).toRotationMatrix();
    auto mesh = detail::tetrahedra(skin.mesh, task);
    if (!mesh || !fills(*mesh, skin.mesh)) continue;
    for (int& parent : mesh->boundary_parent) parent = skin.parent[static_cast<size_t>(parent)];
    return mesh;
  }
  return {};
}

/// Beyond that a factorization takes tens of GB.
constexpr double kMostTetrahedra = 1e6;

void refuse_too_fine(const SurfaceMesh& surface, double edge, const Place& place) {
  const double count = detail::six_volume(surface) / (edge * edge * edge / std::sqrt(2.0));
  if (count <= kMostTetrahedra) return;
  throw InputError(
      place,
      fmt::format("an edge of {:.4g} would take about {:.2g} million tetrahedra", edge,
                  count / 1e6),
      fmt::format("an edge of at least {:.2g}", 1.05 * edge * std::cbrt(count / kMostTetrahedra)));
}

}  // namespace

TetMesh fill(const SurfaceMesh& surface, const FillOptions& options, const Place& place) {
  if (surface.triangles.empty()) {
    throw InputError(place, "the surface has no triangles", "a closed surface");
  }
  const SurfaceFaults faults = inspect(surface);
  const bool crosses = !faults.self_intersections.empty();
  SurfaceFaults others = faults;
  others.self_intersections.clear();
  if (!others.clean()) throw detail::no_body(surface, others, place);
  detail::refuse_shells_within(surface, place);
  const double edge = options.edge > 0 ? options.edge : detail::diagonal(surface.X) / 12.0;
  refuse_too_fine(surface, edge, place);
  TetGenTask task;
  task.holes = detail::cavities(surface);
  task.radius_edge_ratio = options.radius_edge_ratio;
  task.min_dihedral_deg = options.min_dihedral_deg;
  // Bounded by -a, volumes come out at about two thirds of the bound: hence 1.5 times the volume of
  // the regular tetrahedron.
  task.volume = 1.5 * edge * edge * edge / (6.0 * std::sqrt(2.0));
  const double count = expected(surface, edge);
  task.most_points = 1e5 + count;
  task.seconds = 30.0 + 2e-4 * count;
  // TetGen refines a boundary by bisecting every segment of it until quality is met, which makes
  // five to ten times more elements than asked for. So the surface is cut to the target edge here
  // and kept (-Y). Edges come out at 0.7 to 1.4 of the target, their mean near it.
  const double thickness = detail::six_volume(surface) / 3.0 / area(surface);
  double tolerance = std::min(0.002 * edge, 0.01 * thickness);
  if (crosses) tolerance = std::max(tolerance, detail::rounding(surface));
  Subdivided skin = detail::skin_of(surface, 1.4 * edge, tolerance), plain;
  const bool sound = inspect(skin.mesh).clean();
  if (crosses && !sound) throw detail::no_body(surface, faults, place);
  if (!sound) skin = {};
  if (!crosses) plain = detail::subdivide(surface, 1.4 * edge);
  for (const bool keep_surface : {true, false}) {
    for (const Subdivided* one : {&skin, &plain}) {
      if (auto mesh = filled(*one, task, keep_surface)) return with_order(*mesh, options.order);
    }
  }
  throw InputError(
      place,
      "the surface could not be filled with tetrahedra: TetGen gave up, though no open "
      "edge or self-intersection was found",
      "a surface without slivers");
}

}  // namespace hookeye
