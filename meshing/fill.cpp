// A closed surface filled with tetrahedra: what TetGen is asked, how often, and what it may answer.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "meshing/coarsen.h"
#include "meshing/detail.h"
#include "meshing/skin.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace {

using detail::Subdivided;
using detail::TetGenTask;

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

/// The attempts at one body. TetGen gives up on about one in a hundred because of the way in which
/// points happen to be rounded; turned a little it takes the same one.
class Attempts {
 public:
  Attempts(TetGenTask task, double seconds) : task_(std::move(task)), seconds_(seconds) {}

  std::optional<TetMesh> at(const Subdivided& skin, bool keep_surface) {
    if (skin.mesh.triangles.empty()) return {};
    task_.keep_surface = keep_surface;
    for (const auto& [angle, about] :
         {std::pair{0.0, Vector3d(1, 0, 0)}, {0.7, Vector3d(1, 2, 3)}, {1.1, Vector3d(-3, 1, 2)}}) {
      if (count_ > 0 && seconds_ - used_ < kShortest) return {};
      task_.turn = Eigen::AngleAxisd(angle, about.normalized()).toRotationMatrix();
      task_.seconds = std::min(seconds_ - used_, kLargestShare * seconds_);
      detail::TetGenAnswer answer = detail::tetrahedra(skin.mesh, task_);
      ++count_;
      used_ += answer.seconds;
      // What refines without end does so turned as well.
      if (!answer.in_time) return {};
      if (!answer.mesh || !fills(*answer.mesh, skin.mesh)) continue;
      for (int& parent : answer.mesh->boundary_parent)
        parent = skin.parent[static_cast<size_t>(parent)];
      return std::move(answer.mesh);
    }
    return {};
  }

  /// "in 5 attempts, 3.1 s of computing (limit 120 s)".
  std::string told() const {
    return fmt::format("in {} attempt{}, {:.2g} s of computing (limit {:.3g} s)", count_,
                       count_ == 1 ? "" : "s", used_, seconds_);
  }

 private:
  static constexpr double kLargestShare = 0.3;  ///< of the time, for one attempt
  static constexpr double kShortest = 1.0;      ///< [s]: limits of a process are whole seconds
  TetGenTask task_;
  double seconds_, used_ = 0.0;  ///< of computing, together
  int count_ = 0;
};

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

/// Three times the triangles that equilateral ones of the edge would be: the mesh would follow the
/// surface's, and have unknowns that nobody asked for.
bool finer_than(const SurfaceMesh& surface, double edge) {
  const double wanted = detail::area(surface) / (std::sqrt(3.0) / 4.0 * edge * edge);
  return static_cast<double>(surface.triangles.size()) > 3.0 * wanted;
}

std::string coarser(const SurfaceMesh& surface, const SurfaceMesh& skin, bool taken, double edge) {
  if (!taken)
    return fmt::format(
        "the surface's {} triangles are much finer than the mesh's edge of {:.3g}, and could not "
        "be made coarser: the mesh is as fine as they are",
        surface.triangles.size(), edge);
  return fmt::format(
      "the surface's {} triangles are finer than the mesh's edge of {:.3g}: the mesh has {} in "
      "their place, within {:.2g} of them",
      surface.triangles.size(), edge, skin.triangles.size(), detail::apart(surface, skin));
}

/// What the attempts may take together [s of computing]: most bodies take less than one.
constexpr double kSeconds = 120.0, kSecondsEach = 1e-4;  ///< the second for each tetrahedron

}  // namespace

TetMesh fill(const SurfaceMesh& surface, const FillOptions& options, const Place& place,
             std::vector<std::string>* said) {
  const double edge = options.edge > 0 ? options.edge : detail::diagonal(surface.X) / 12.0;
  const double count = surface.triangles.empty() ? 0.0 : expected(surface, edge);
  return detail::fill_within(surface, options, place, kSeconds + kSecondsEach * count, said);
}

TetMesh detail::fill_within(const SurfaceMesh& surface, const FillOptions& options,
                            const Place& place, double seconds, std::vector<std::string>* said) {
  if (surface.triangles.empty()) {
    throw InputError(place, "the surface has no triangles", "a closed surface");
  }
  const SurfaceFaults faults = inspect(surface);
  const bool crosses = !faults.self_intersections.empty();
  SurfaceFaults others = faults;
  others.self_intersections.clear();
  if (!others.clean()) throw no_body(surface, others, place);
  refuse_shells_within(surface, place);
  const double edge = options.edge > 0 ? options.edge : diagonal(surface.X) / 12.0;
  refuse_too_fine(surface, edge, place);
  TetGenTask task;
  task.holes = cavities(surface);
  task.radius_edge_ratio = options.radius_edge_ratio;
  task.min_dihedral_deg = options.min_dihedral_deg;
  // Bounded by -a, volumes come out at about two thirds of the bound: hence 1.5 times the volume of
  // the regular tetrahedron.
  task.volume = 1.5 * edge * edge * edge / (6.0 * std::sqrt(2.0));
  task.most_points = 1e5 + expected(surface, edge);
  // TetGen refines a boundary by bisecting every segment of it until quality is met, which makes
  // five to ten times more elements than asked for. So the surface is cut to the target edge here
  // and kept (-Y). Edges come out at 0.7 to 1.4 of the target, their mean near it.
  const double thickness = six_volume(surface) / 3.0 / area(surface);
  double tolerance = std::min(0.002 * edge, 0.01 * thickness);
  if (crosses) tolerance = std::max(tolerance, rounding(surface));
  const bool too_fine = finer_than(surface, edge);
  Subdivided skin = too_fine ? skin_of(coarsened(surface, edge, 0.05 * std::min(edge, thickness)),
                                       1.4 * edge, tolerance)
                             : skin_of(surface, 1.4 * edge, tolerance);
  Subdivided plain;
  const bool sound = inspect(skin.mesh).clean();
  if (crosses && !sound) throw no_body(surface, faults, place);
  if (!sound) skin = {};
  if (!crosses) plain = subdivide(surface, 1.4 * edge);
  Attempts attempts(task, seconds);
  for (const bool keep_surface : {true, false}) {
    for (const Subdivided* one : {&skin, &plain}) {
      auto mesh = attempts.at(*one, keep_surface);
      if (!mesh) continue;
      if (too_fine && said && skin.mesh.triangles.size() < surface.triangles.size())
        said->push_back(coarser(surface, skin.mesh, one == &skin, edge));
      return with_order(*mesh, options.order);
    }
  }
  throw InputError(place,
                   fmt::format("TetGen could not fill the surface with tetrahedra {}; no hole and "
                               "no self-intersection was found. It is tightest {}",
                               attempts.told(), tightest(sound ? skin.mesh : surface)),
                   "parts of a surface that are clearly apart or joined, and no slivers");
}

}  // namespace hookeye
