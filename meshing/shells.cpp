// Closed parts of a surface, which of them lie within others, and the cavities among them.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "meshing/detail.h"

namespace hookeye::detail {

double six_volume(const SurfaceMesh& s) {
  if (s.X.cols() == 0) return 0.0;
  const Vector3d origin = s.X.rowwise().mean();
  double sum = 0.0;
  for (const auto& t : s.triangles) {
    const Vector3d a = s.X.col(t[0]) - origin, b = s.X.col(t[1]) - origin,
                   c = s.X.col(t[2]) - origin;
    sum += a.dot(b.cross(c));
  }
  return sum;
}

double area(const SurfaceMesh& s) {
  double sum = 0.0;
  for (const auto& t : s.triangles) {
    const Vector3d a = s.X.col(t[0]), b = s.X.col(t[1]), c = s.X.col(t[2]);
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

namespace {

/// Smallest number of a vertex of the same shell, for every vertex.
std::vector<int> connected(const SurfaceMesh& surface) {
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

std::array<Vector3d, 3> corners(const SurfaceMesh& surface, int triangle) {
  const auto& [a, b, c] = surface.triangles[static_cast<size_t>(triangle)];
  return {surface.X.col(a), surface.X.col(b), surface.X.col(c)};
}

/// How often a shell goes round a point: the sum of its triangles' solid angles (van Oosterom and
/// Strackee 1983) by that of a sphere. No ray is cast, so none can graze an edge.
double winding(const SurfaceMesh& surface, const Shell& shell, const Vector3d& point) {
  double sum = 0.0;
  for (const int t : shell.triangles) {
    auto [a, b, c] = corners(surface, t);
    a -= point, b -= point, c -= point;
    const double u = a.norm(), v = b.norm(), w = c.norm();
    sum +=
        2.0 * std::atan2(a.dot(b.cross(c)), u * v * w + a.dot(b) * w + b.dot(c) * u + c.dot(a) * v);
  }
  return sum / (4.0 * std::numbers::pi);
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

std::vector<Shell> shells(const SurfaceMesh& surface) {
  const std::vector<int> part = connected(surface);
  std::map<int, Shell> by_part;
  std::map<int, Eigen::AlignedBox3d> box;
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
    const int id = part[surface.triangles[t][0]];
    const auto [a, b, c] = corners(surface, t);
    const Vector3d origin = surface.X.col(id);
    Shell& own = by_part[id];
    own.triangles.push_back(t);
    own.six_volume += (a - origin).dot((b - origin).cross(c - origin));
    for (const Vector3d& x : {a, b, c}) box[id].extend(x);
  }
  std::vector<Shell> out;
  for (auto& [id, own] : by_part) {
    const Vector3d point = surface.X.col(id);
    for (const auto& [other, around] : by_part)
      if (other != id && box[other].contains(point))
        own.depth += std::abs(winding(surface, around, point)) > 0.5;
    out.push_back(own);
  }
  return out;
}

std::vector<int> inside_out(const SurfaceMesh& surface) {
  std::vector<int> out;
  for (const Shell& shell : shells(surface))
    if (shell.depth % 2 == 0 && shell.six_volume < 0.0)
      out.insert(out.end(), shell.triangles.begin(), shell.triangles.end());
  std::ranges::sort(out);
  return out;
}

void refuse_shells_within(const SurfaceMesh& surface, const Place& place) {
  for (const Shell& shell : shells(surface)) {
    if (shell.depth % 2 == 0 || shell.six_volume < 0.0) continue;
    throw InputError(
        place,
        fmt::format("the closed part at {} lies within another and is turned outwards, as if there "
                    "were material within material",
                    where(corners(surface, shell.triangles[0])[0])),
        "one surface for each piece of material; that of a cavity is turned inwards");
  }
}

std::vector<Vector3d> cavities(const SurfaceMesh& surface) {
  std::vector<Vector3d> out;
  for (const Shell& shell : shells(surface)) {
    if (shell.depth % 2 == 0) continue;
    const int largest = *std::ranges::max_element(shell.triangles, {}, [&](int t) {
      const auto [a, b, c] = corners(surface, t);
      return (b - a).cross(c - a).norm();
    });
    const auto [a, b, c] = corners(surface, largest);
    const Vector3d from = (a + b + c) / 3.0, away = (b - a).cross(c - a).normalized();
    double nearest = std::numeric_limits<double>::infinity();
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
      const auto [p, q, r] = corners(surface, t);
      if (t != largest) nearest = std::min(nearest, hit(from, away, p, q, r));
    }
    if (std::isfinite(nearest)) out.push_back(from + 0.5 * nearest * away);
  }
  return out;
}

}  // namespace hookeye::detail
