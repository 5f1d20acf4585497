// What is wrong with a surface.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <set>

#include "meshing/detail.h"
#include "meshing/triangle_tree.h"

namespace hookeye {

namespace {

using detail::orientation;
using Triangle = std::array<int, 3>;

bool has_no_area(const SurfaceMesh& s, const Triangle& t) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
  const Vector3d a = s.X.col(t[0]), u = Vector3d(s.X.col(t[1])) - a,
                 v = Vector3d(s.X.col(t[2])) - a;
  const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
  return u.cross(v).norm() <= 1e-12 * longest;
}

struct EdgeUse {
  int triangle;
  bool forward;  ///< runs from the smaller vertex to the larger
};
using Edges = std::map<std::array<int, 2>, std::vector<EdgeUse>>;

Edges edges_of(const SurfaceMesh& s, const std::set<int>& left_out) {
  Edges edges;
  for (int t = 0; t < static_cast<int>(s.triangles.size()); ++t) {
    if (left_out.contains(t)) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = s.triangles[t][k], b = s.triangles[t][(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}].push_back({t, a < b});
    }
  }
  return edges;
}

/// Orients each connected part by its first triangle; those that disagree with the majority of
/// their part (by count) are inverted.
std::vector<int> find_inverted(const SurfaceMesh& s, const Edges& edges) {
  std::vector<std::vector<std::pair<int, bool>>> next(s.triangles.size());
  for (const auto& [edge, uses] : edges) {
    if (uses.size() != 2) continue;
    const bool agree = uses[0].forward != uses[1].forward;
    next[uses[0].triangle].emplace_back(uses[1].triangle, agree);
    next[uses[1].triangle].emplace_back(uses[0].triangle, agree);
  }
  std::vector<int> side(s.triangles.size(), 0), inverted;
  for (size_t seed = 0; seed < s.triangles.size(); ++seed) {
    if (side[seed] != 0 || next[seed].empty()) continue;
    std::vector<int> part{static_cast<int>(seed)};
    side[seed] = 1;
    int sum = 0;
    for (size_t i = 0; i < part.size(); ++i) {
      sum += side[part[i]];
      for (const auto& [other, agree] : next[part[i]]) {
        if (side[other] != 0) continue;
        side[other] = agree ? side[part[i]] : -side[part[i]];
        part.push_back(other);
      }
    }
    for (int t : part) {
      if (side[t] == (sum >= 0 ? -1 : 1)) inverted.push_back(t);
    }
  }
  std::sort(inverted.begin(), inverted.end());
  return inverted;
}

/// The first of the inverted triangles beside one that is not, and a corner on the edge between
/// them: those around it may be turned as well.
std::pair<int, int> first_turned(const SurfaceMesh& s, const std::vector<int>& inverted) {
  const Edges edges = edges_of(s, {});
  for (const int t : inverted)
    for (size_t k = 0; k < 3; ++k) {
      const int a = s.triangles[t][k], b = s.triangles[t][(k + 1) % 3];
      const std::vector<EdgeUse>& uses = edges.at({std::min(a, b), std::max(a, b)});
      if (uses.size() == 2 && uses[0].forward == uses[1].forward) return {t, a};
    }
  return {inverted[0], s.triangles[inverted[0]][0]};
}

/// Segment pq against triangle abc, endpoints and edges included; coplanar segments do not count.
bool pierces(const Vector3d& p, const Vector3d& q, const Vector3d& a, const Vector3d& b,
             const Vector3d& c) {
  const int sp = orientation(a, b, c, p), sq = orientation(a, b, c, q);
  if (sp * sq > 0 || (sp == 0 && sq == 0)) return false;
  const int u = orientation(p, q, a, b), v = orientation(p, q, b, c), w = orientation(p, q, c, a);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

/// Sign of the area of abc, exact.
int turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const auto lifted = [](const Vector2d& x, double z) { return Vector3d(x.x(), x.y(), z); };
  return orientation(lifted(a, 0.0), lifted(b, 0.0), lifted(c, 0.0), lifted(a, 1.0));
}

/// Two coplanar triangles share interior points: no edge of either separates them.
bool overlap_in_plane(const std::array<Vector3d, 3>& s, const std::array<Vector3d, 3>& t) {
  const Vector3d normal = (s[1] - s[0]).cross(s[2] - s[0]);
  int drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  const auto flat = [&](const Vector3d& x) {
    return Vector2d(x[(drop + 1) % 3], x[(drop + 2) % 3]);
  };
  const auto separated = [&](const std::array<Vector3d, 3>& one,
                             const std::array<Vector3d, 3>& two) {
    const int inside = turn(flat(one[0]), flat(one[1]), flat(one[2]));
    for (int k = 0; k < 3; ++k) {
      const Vector2d a = flat(one[k]), b = flat(one[(k + 1) % 3]);
      bool all_out = true;
      for (const Vector3d& x : two) all_out = all_out && inside * turn(a, b, flat(x)) <= 0;
      if (all_out) return true;
    }
    return false;
  };
  return !separated(s, t) && !separated(t, s);
}

bool intersect(const SurfaceMesh& m, const Triangle& s, const Triangle& t) {
  std::array<Vector3d, 3> x, y;
  for (int k = 0; k < 3; ++k) {
    x[k] = m.X.col(s[k]);
    y[k] = m.X.col(t[k]);
  }
  const auto has = [](const Triangle& tri, int v) {
    return std::ranges::find(tri, v) != tri.end();
  };
  bool coplanar = true;
  for (const Vector3d& p : y) coplanar = coplanar && orientation(x[0], x[1], x[2], p) == 0;
  if (coplanar) return overlap_in_plane(x, y);
  for (int k = 0; k < 3; ++k) {
    // An edge that starts at a shared vertex touches the other triangle there, rightly; what else
    // it does is seen by the edges of the other triangle.
    const int j = (k + 1) % 3;
    if (!has(t, s[k]) && !has(t, s[j]) && pierces(x[k], x[j], y[0], y[1], y[2])) return true;
    if (!has(s, t[k]) && !has(s, t[j]) && pierces(y[k], y[j], x[0], x[1], x[2])) return true;
  }
  return false;
}

std::vector<std::array<int, 2>> find_self_intersections(const SurfaceMesh& s,
                                                        const std::set<int>& left_out) {
  std::vector<std::array<int, 2>> pairs;
  const detail::TriangleTree tree(s.X, s.triangles);
  for (int t = 0; t < static_cast<int>(s.triangles.size()); ++t) {
    if (left_out.contains(t)) continue;
    for (int other : tree.touching(tree.box_of(t))) {
      if (other <= t || left_out.contains(other)) continue;
      if (intersect(s, s.triangles[t], s.triangles[other])) pairs.push_back({t, other});
    }
  }
  return pairs;
}

}  // namespace

bool SurfaceFaults::clean() const {
  return open_edges.empty() && crowded_edges.empty() && self_intersections.empty() &&
         degenerate.empty() && duplicated.empty() && inverted.empty() && !inside_out;
}

std::string SurfaceFaults::describe(const SurfaceMesh& s) const {
  const auto at = [&](int vertex) { return detail::where(s.X.col(vertex)); };
  const auto more = [](size_t n, const char* what) {
    return n > 1 ? fmt::format(" ({} {} in all)", n, what) : std::string();
  };
  if (!degenerate.empty()) {
    return fmt::format("triangle {} at {} has no area{}", degenerate[0],
                       at(s.triangles[degenerate[0]][0]),
                       more(degenerate.size(), "such triangles"));
  }
  if (!duplicated.empty()) {
    return fmt::format("triangle {} at {} is there twice{}", duplicated[0],
                       at(s.triangles[duplicated[0]][0]),
                       more(duplicated.size(), "such triangles"));
  }
  if (!open_edges.empty()) {
    return fmt::format("there is a hole: the edge from {} to {} has one triangle{}",
                       at(open_edges[0][0]), at(open_edges[0][1]),
                       more(open_edges.size(), "open edges"));
  }
  if (!crowded_edges.empty()) {
    return fmt::format("more than two triangles meet at the edge from {} to {}{}",
                       at(crowded_edges[0][0]), at(crowded_edges[0][1]),
                       more(crowded_edges.size(), "such edges"));
  }
  if (!inverted.empty()) {
    const auto [triangle, corner] = first_turned(s, inverted);
    return fmt::format("triangle {} at {} is turned against its neighbours{}", triangle, at(corner),
                       more(inverted.size(), "such triangles"));
  }
  if (!self_intersections.empty()) {
    const auto [a, b] = self_intersections[0];
    return fmt::format("triangles {} and {} intersect near {}{}", a, b, at(s.triangles[b][0]),
                       more(self_intersections.size(), "such pairs"));
  }
  if (inside_out) return "the surface is inside out: its triangles are turned inwards";
  return "no fault";
}

InputError detail::no_body(const SurfaceMesh& surface, const SurfaceFaults& faults,
                           const Place& place) {
  return {place, fmt::format("the surface does not bound a body: {}", faults.describe(surface)),
          "a closed surface without self-intersections, triangles turned outwards"};
}

SurfaceFaults inspect(const SurfaceMesh& surface) {
  SurfaceFaults faults;
  std::set<Triangle> seen;
  std::set<int> left_out;
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
    Triangle sorted = surface.triangles[t];
    if (has_no_area(surface, sorted)) {
      faults.degenerate.push_back(t);
      left_out.insert(t);
      continue;
    }
    std::sort(sorted.begin(), sorted.end());
    if (!seen.insert(sorted).second) {
      faults.duplicated.push_back(t);
      left_out.insert(t);
    }
  }
  const Edges edges = edges_of(surface, left_out);
  for (const auto& [edge, uses] : edges) {
    if (uses.size() == 1) faults.open_edges.push_back(edge);
    if (uses.size() > 2) faults.crowded_edges.push_back(edge);
  }
  faults.inverted = find_inverted(surface, edges);
  faults.self_intersections = find_self_intersections(surface, left_out);
  faults.inside_out =
      faults.open_edges.empty() && faults.inverted.empty() && !detail::inside_out(surface).empty();
  return faults;
}

}  // namespace hookeye
