#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "meshing/detail.h"

namespace hookeye::detail {

namespace {

/// Smallest number of a vertex of the same shell, for every vertex.
std::vector<int> shells(const SurfaceMesh& surface) {
  std::vector<int> parent(surface.X.cols());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : surface.triangles)
    for (int k = 1; k < 3; ++k) {
      const int a = root(t[0]), b = root(t[k]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  for (int v = 0; v < static_cast<int>(parent.size()); ++v) parent[v] = root(v);
  return parent;
}

/// Distance along a ray to a triangle (Moeller and Trumbore 1997); infinite where it passes by.
/// Near misses count: a ray through an edge must not slip between its triangles.
double hit(const Vector3d& from, const Vector3d& along, const Vector3d& a, const Vector3d& b,
           const Vector3d& c) {
  constexpr double kNone = std::numeric_limits<double>::infinity(), kNear = 1e-9;
  const Vector3d e1 = b - a, e2 = c - a, p = along.cross(e2);
  const double det = e1.dot(p);
  if (det == 0.0) return kNone;
  const Vector3d s = from - a, q = s.cross(e1);
  const double u = s.dot(p) / det, v = along.dot(q) / det, t = e2.dot(q) / det;
  return u >= -kNear && v >= -kNear && u + v <= 1.0 + kNear && t > 0.0 ? t : kNone;
}

}  // namespace

std::vector<Vector3d> cavities(const SurfaceMesh& surface) {
  const std::vector<int> shell = shells(surface);
  const auto corner = [&](int t, int k) -> Vector3d {
    return surface.X.col(surface.triangles[t][k]);
  };
  struct Shell {
    double six_volume = 0.0, area = 0.0;
    int largest = -1;  ///< triangle
  };
  std::map<int, Shell> all;
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
    const Vector3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    Shell& own = all[shell[surface.triangles[t][0]]];
    const Vector3d origin = surface.X.col(shell[surface.triangles[t][0]]);
    own.six_volume += (a - origin).dot((b - origin).cross(c - origin));
    const double area = (b - a).cross(c - a).norm();
    if (area > own.area) own.area = area, own.largest = t;
  }
  std::vector<Vector3d> out;
  for (const auto& [id, own] : all) {
    if (!(own.six_volume < 0.0)) continue;
    const Vector3d a = corner(own.largest, 0), b = corner(own.largest, 1),
                   c = corner(own.largest, 2);
    const Vector3d from = (a + b + c) / 3.0, away = (b - a).cross(c - a).normalized();
    double nearest = std::numeric_limits<double>::infinity();
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t)
      if (t != own.largest)
        nearest = std::min(nearest, hit(from, away, corner(t, 0), corner(t, 1), corner(t, 2)));
    if (std::isfinite(nearest)) out.push_back(from + 0.5 * nearest * away);
  }
  return out;
}

}  // namespace hookeye::detail
