// Where a sound surface is hardest to fill: for the message when nothing filled it.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "meshing/detail.h"
#include "meshing/triangle_tree.h"

namespace hookeye::detail {
namespace {

using Triangle = std::array<int, 3>;

/// Something small of a surface: how small as a share of the edges around, and in words.
struct Spot {
  double share = std::numeric_limits<double>::infinity();
  std::string told;
};

double longest_edge(const SurfaceMesh& s, const Triangle& t) {
  double longest = 0.0;
  for (size_t k = 0; k < 3; ++k)
    longest = std::max(longest, (s.X.col(t[k]) - s.X.col(t[(k + 1) % 3])).norm());
  return longest;
}

Vector3d normal(const SurfaceMesh& s, const Triangle& t) {
  const Vector3d a = s.X.col(t[0]), b = s.X.col(t[1]), c = s.X.col(t[2]);
  return (b - a).cross(c - a);
}

void note_thinnest(const SurfaceMesh& s, Spot& spot) {
  for (size_t t = 0; t < s.triangles.size(); ++t) {
    const double base = longest_edge(s, s.triangles[t]);
    const double height = normal(s, s.triangles[t]).norm() / base;
    if (height / base >= spot.share) continue;
    spot = {height / base, fmt::format("at {}, in a triangle {:.2g} high and {:.2g} long",
                                       where(s.X.col(s.triangles[t][0])), height, base)};
  }
}

/// Two triangles at an edge that lie nearly on each other.
void note_folds(const SurfaceMesh& s, Spot& spot) {
  std::map<std::pair<int, int>, int> first;
  for (int t = 0; t < static_cast<int>(s.triangles.size()); ++t) {
    const Triangle& c = s.triangles[static_cast<size_t>(t)];
    for (size_t k = 0; k < 3; ++k) {
      const auto edge = std::minmax(c[k], c[(k + 1) % 3]);
      const auto [at, fresh] = first.try_emplace(edge, t);
      if (fresh) continue;
      const Vector3d m = normal(s, c), n = normal(s, s.triangles[static_cast<size_t>(at->second)]);
      const double angle = std::atan2(m.cross(n).norm(), -m.dot(n));
      if (angle >= spot.share) continue;
      spot = {angle,
              fmt::format("at the edge from {} to {}, where two triangles enclose {:.2g} degrees",
                          where(s.X.col(edge.first)), where(s.X.col(edge.second)),
                          angle * 180.0 / std::numbers::pi)};
    }
  }
}

/// Nearest points of two segments (Ericson, Real-Time Collision Detection, 5.1.9), their distance.
double apart(const Vector3d& p, const Vector3d& q, const Vector3d& r, const Vector3d& s) {
  const Vector3d d = q - p, e = s - r, w = p - r;
  const double a = d.squaredNorm(), b = d.dot(e), c = e.squaredNorm(), f = e.dot(w), g = d.dot(w);
  const double det = a * c - b * b;
  double u = det > 0.0 ? std::clamp((b * f - g * c) / det, 0.0, 1.0) : 0.0;
  double v = c > 0.0 ? (b * u + f) / c : 0.0;
  if (v < 0.0 || v > 1.0) {
    v = std::clamp(v, 0.0, 1.0);
    u = a > 0.0 ? std::clamp((b * v - g) / a, 0.0, 1.0) : 0.0;
  }
  return (p + u * d - r - v * e).norm();
}

double apart(const SurfaceMesh& s, const Triangle& one, const Triangle& two) {
  const auto at = [&](const Triangle& t, size_t k) { return Vector3d(s.X.col(t[k % 3])); };
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < 3; ++i) {
    for (const auto& [from, to] : {std::pair{&one, &two}, {&two, &one}}) {
      const Vector3d x = at(*from, i);
      const Vector3d w = closest_weights(x, at(*to, 0), at(*to, 1), at(*to, 2));
      least =
          std::min(least, (w[0] * at(*to, 0) + w[1] * at(*to, 1) + w[2] * at(*to, 2) - x).norm());
    }
    for (size_t j = 0; j < 3; ++j)
      least = std::min(least, apart(at(one, i), at(one, i + 1), at(two, j), at(two, j + 1)));
  }
  return least;
}

/// Triangles without a common corner that nearly touch.
void note_gaps(const SurfaceMesh& s, Spot& spot) {
  const TriangleTree tree(s.X, s.triangles);
  for (int t = 0; t < static_cast<int>(s.triangles.size()); ++t) {
    const Triangle& one = s.triangles[static_cast<size_t>(t)];
    const double base = longest_edge(s, one);
    Eigen::AlignedBox3d around = tree.box_of(t);
    const double reach = std::min(spot.share, 1.0) * base;
    around.extend(Vector3d(around.min().array() - reach));
    around.extend(Vector3d(around.max().array() + reach));
    for (const int other : tree.touching(around)) {
      const Triangle& two = s.triangles[static_cast<size_t>(other)];
      if (other <= t || std::ranges::find_first_of(one, two) != one.end()) continue;
      const double distance = apart(s, one, two);
      if (distance / base >= spot.share) continue;
      spot = {distance / base, fmt::format("near {}, where two parts pass at a distance of {:.2g}",
                                           where(s.X.col(one[0])), distance)};
    }
  }
}

}  // namespace

std::string tightest(const SurfaceMesh& surface) {
  Spot spot;
  note_thinnest(surface, spot);
  note_folds(surface, spot);
  note_gaps(surface, spot);
  return spot.told;
}

}  // namespace hookeye::detail
