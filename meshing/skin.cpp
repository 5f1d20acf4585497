#include "meshing/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "meshing/soup.h"
#include "meshing/triangle_tree.h"

namespace hookeye::detail {
namespace {

using Triangle = std::array<int, 3>;

/// Smallest angle of a triangle [rad].
double smallest_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto at = [](const Vector3d& p, const Vector3d& q, const Vector3d& r) {
    const Vector3d u = q - p, v = r - p;
    return std::atan2(u.cross(v).norm(), u.dot(v));
  };
  return std::min({at(a, b, c), at(b, c, a), at(c, a, b)});
}

constexpr double kBadAngle = 15.0 * std::numbers::pi / 180.0;  ///< [rad] of a bad triangle
/// Good shapes change for so much wider an angle: within one triangle of the surface, and where the
/// new ones lie on several (regions count by the surface's triangles).
constexpr double kWider = 1.3, kMuchWider = 2.0;

/// Turns and contracts edges where triangles are bad, while that widens the smallest angle.
class Mending {
 public:
  Mending(Subdivided& skin, double tolerance, double longest)
      : skin_(skin),
        tolerance_(tolerance),
        longest_(longest),
        around_(skin.mesh.X.cols()),
        left_(skin.mesh.triangles.size()) {
    for (int t = 0; t < size(); ++t)
      for (const int v : skin.mesh.triangles[t]) around_[v].push_back(t);
    alive_.assign(skin.mesh.triangles.size(), true);
  }

  void run() {
    std::vector<int> open(skin_.mesh.triangles.size());
    std::iota(open.rbegin(), open.rend(), 0);
    // Every change makes the sorted list of angles greater, so this ends.
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      if (alive_[t]) mend(t, open);
    }
    size_t kept = 0;
    for (size_t t = 0; t < skin_.mesh.triangles.size(); ++t) {
      if (!alive_[t]) continue;
      skin_.mesh.triangles[kept] = skin_.mesh.triangles[t];
      skin_.parent[kept++] = skin_.parent[t];
    }
    skin_.mesh.triangles.resize(kept);
    skin_.parent.resize(kept);
  }

 private:
  /// Triangles that go and what comes for them.
  struct Change {
    std::vector<int> gone;
    std::vector<Triangle> fresh;
    std::vector<int> left;  ///< vertices that lie on no triangle's corner any more
    double angle = 0.0;     ///< smallest of the fresh
  };

  int size() const { return static_cast<int>(skin_.mesh.triangles.size()); }
  Vector3d at(int v) const { return skin_.mesh.X.col(v); }
  double angle(const Triangle& t) const { return smallest_angle(at(t[0]), at(t[1]), at(t[2])); }
  Vector3d area(const Triangle& t) const {
    return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
  }
  static bool has(const Triangle& t, int v) { return std::ranges::find(t, v) != t.end(); }

  std::vector<int> beside(int p, int q) const {
    std::vector<int> both;
    for (const int t : around_[p])
      if (has(skin_.mesh.triangles[t], q)) both.push_back(t);
    return both;
  }
  static int third(const Triangle& t, int p, int q) {
    for (const int v : t)
      if (v != p && v != q) return v;
    return -1;
  }
  double smallest(const std::vector<int>& triangles) const {
    double least = std::numbers::pi;
    for (const int t : triangles) least = std::min(least, angle(skin_.mesh.triangles[t]));
    return least;
  }

  /// The edge from p to q of triangle s replaced by the one between the opposite vertices.
  void turned(int s, int p, int q, Change& best) const {
    const std::vector<int> both = beside(p, q);
    if (both.size() != 2) return;
    const int t = both[0] == s ? both[1] : both[0];
    const int a = third(skin_.mesh.triangles[s], p, q), b = third(skin_.mesh.triangles[t], p, q);
    if (a < 0 || b < 0 || a == b || !beside(a, b).empty()) return;
    Change change{{s, t}, {{a, p, b}, {b, q, a}}, {}};
    const Vector3d across = (at(q) - at(p)).cross(at(a) - at(b));  // of the quadrilateral, doubled
    for (const Triangle& fresh : change.fresh)
      if (area(fresh).dot(across) <= 0.0) return;
    const double apart = std::abs((at(a) - at(p)).dot(across));  // the edges pass each other so far
    if (apart > tolerance_ * across.norm()) return;
    consider(change, best);
  }

  /// Vertex u drawn to its neighbour v.
  void contracted(int u, int v, Change& best) const {
    const std::vector<int> both = beside(u, v);
    if (both.size() != 2) return;
    std::set<int> near_u, near_v;
    for (const int t : around_[u])
      near_u.insert(skin_.mesh.triangles[t].begin(), skin_.mesh.triangles[t].end());
    for (const int t : around_[v])
      near_v.insert(skin_.mesh.triangles[t].begin(), skin_.mesh.triangles[t].end());
    if (near_u.size() != around_[u].size() + 1) return;  // not one fan
    int common = 0;
    for (const int w : near_u) common += near_v.contains(w);
    if (common != 4) return;  // u, v and the two vertices opposite
    Change change{around_[u], {}, {}};
    for (const int t : around_[u]) {
      if (has(skin_.mesh.triangles[t], v)) continue;
      Triangle fresh = skin_.mesh.triangles[t];
      std::ranges::replace(fresh, u, v);
      const Vector3d old_area = area(skin_.mesh.triangles[t]), new_area = area(fresh);
      const double larger = std::max(old_area.norm(), new_area.norm());
      if (std::abs(old_area.dot(at(v) - at(u))) > tolerance_ * larger) return;
      if (new_area.dot(against(fresh, v, t)) <= 0.0) return;
      for (const int w : fresh)
        if ((at(w) - at(v)).norm() > longest_) return;
      change.fresh.push_back(fresh);
    }
    change.left.push_back(u);
    consider(change, best);
  }

  /// What the normal of a fresh triangle must agree with: the old one's, or, where that has none to
  /// speak of, that of the neighbour on the far side.
  Vector3d against(const Triangle& fresh, int v, int old) const {
    const Vector3d before = area(skin_.mesh.triangles[old]);
    std::array<int, 2> far{};
    for (size_t i = 0; const int w : fresh)
      if (w != v) far[i++ % 2] = w;
    const double base = (at(far[0]) - at(far[1])).norm();
    if (before.norm() > tolerance_ * base || base == 0.0) return before;
    for (const int t : beside(far[0], far[1]))
      if (t != old) return area(skin_.mesh.triangles[t]);
    return before;
  }

  void consider(Change& change, Change& best) const {
    change.angle = std::numbers::pi;
    for (const Triangle& t : change.fresh) change.angle = std::min(change.angle, angle(t));
    const double before = smallest(change.gone);
    const double wanted = before < kBadAngle   ? 1.001 * before + 1e-9
                          : one_parent(change) ? kWider * before
                                               : kMuchWider * before;
    if (change.angle < wanted || change.angle <= best.angle) return;
    for (const int t : change.gone)
      change.left.insert(change.left.end(), left_[t].begin(), left_[t].end());
    for (const int v : change.left)
      if (nearest(v, change).second > tolerance_) return;
    best = change;
  }

  bool one_parent(const Change& change) const {
    const int parent = skin_.parent[change.gone[0]];
    return parent != kSeveral &&
           std::ranges::all_of(change.gone, [&](int t) { return skin_.parent[t] == parent; });
  }

  /// The fresh triangle nearest to a vertex, and its distance.
  std::pair<size_t, double> nearest(int v, const Change& change) const {
    std::pair<size_t, double> best{0, std::numeric_limits<double>::infinity()};
    for (size_t i = 0; i < change.fresh.size(); ++i) {
      const auto [a, b, c] = change.fresh[i];
      const Vector3d w = closest_weights(at(v), at(a), at(b), at(c));
      const double distance = (w[0] * at(a) + w[1] * at(b) + w[2] * at(c) - at(v)).norm();
      if (distance < best.second) best = {i, distance};
    }
    return best;
  }

  void mend(int t, std::vector<int>& open) {
    Change best;
    const Triangle corners = skin_.mesh.triangles[t];
    const bool bad = angle(corners) < kBadAngle;
    for (size_t k = 0; k < 3; ++k) {
      const int p = corners[k], q = corners[(k + 1) % 3];
      turned(t, p, q, best);
      if (!bad) continue;
      contracted(p, q, best);
      contracted(q, p, best);
    }
    if (!best.gone.empty()) apply(best, open);
  }

  void apply(const Change& change, std::vector<int>& open) {
    const int parent = one_parent(change) ? skin_.parent[change.gone[0]] : kSeveral;
    for (const int t : change.gone) {
      for (const int v : skin_.mesh.triangles[t]) std::erase(around_[v], t);
      alive_[t] = false;
      left_[t].clear();
    }
    for (size_t i = 0; i < change.fresh.size(); ++i) {
      const int t = change.gone[i];
      skin_.mesh.triangles[t] = change.fresh[i];
      skin_.parent[t] = parent;
      alive_[t] = true;
      for (const int v : change.fresh[i]) around_[v].push_back(t);
    }
    for (const int v : change.left) left_[change.gone[nearest(v, change).first]].push_back(v);
    for (const Triangle& fresh : change.fresh)
      for (const int v : fresh) open.insert(open.end(), around_[v].begin(), around_[v].end());
  }

  Subdivided& skin_;
  double tolerance_;
  double longest_;
  std::vector<std::vector<int>> around_;  ///< triangles at each vertex
  std::vector<std::vector<int>> left_;    ///< vertices that now lie on each triangle
  std::vector<bool> alive_;
};

}  // namespace

Subdivided skin_of(const SurfaceMesh& surface, double longest, double tolerance) {
  Subdivided skin;
  skin.mesh.X = surface.X;
  skin.mesh.triangles = surface.triangles;
  skin.parent.resize(surface.triangles.size());
  std::iota(skin.parent.begin(), skin.parent.end(), 0);
  constexpr int kRounds = 30;  // far more than were ever needed: then edges are cut alone
  int round = 0;
  do {
    if (round++ < kRounds) Mending(skin, tolerance, longest).run();
  } while (!bisect(skin, longest).empty());
  drop_unused(skin.mesh);  // the mesher would put nodes there
  return skin;
}

}  // namespace hookeye::detail
