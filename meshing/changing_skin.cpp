#include "meshing/changing_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "meshing/triangle_tree.h"

namespace hookeye::detail {
namespace {

using Triangle = std::array<int, 3>;

bool has(const Triangle& t, int v) { return std::ranges::find(t, v) != t.end(); }

int third(const Triangle& t, int p, int q) {
  for (const int v : t)
    if (v != p && v != q) return v;
  return -1;
}

}  // namespace

double smallest_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto at = [](const Vector3d& p, const Vector3d& q, const Vector3d& r) {
    const Vector3d u = q - p, v = r - p;
    return std::atan2(u.cross(v).norm(), u.dot(v));
  };
  return std::min({at(a, b, c), at(b, c, a), at(c, a, b)});
}

ChangingSkin::ChangingSkin(Subdivided& skin)
    : skin_(skin), around_(skin.mesh.X.cols()), left_(skin.mesh.triangles.size()) {
  for (int t = 0; t < size(); ++t)
    for (const int v : corners(t)) around_[static_cast<size_t>(v)].push_back(t);
  alive_.assign(skin.mesh.triangles.size(), true);
}

std::vector<int> ChangingSkin::beside(int p, int q) const {
  std::vector<int> both;
  for (const int t : around(p))
    if (has(corners(t), q)) both.push_back(t);
  return both;
}

double ChangingSkin::smallest(const std::vector<int>& triangles) const {
  double least = std::numbers::pi;
  for (const int t : triangles) least = std::min(least, angle(corners(t)));
  return least;
}

std::optional<SkinChange> ChangingSkin::turned(int s, int p, int q) const {
  const std::vector<int> both = beside(p, q);
  if (both.size() != 2) return {};
  const int t = both[0] == s ? both[1] : both[0];
  const int a = third(corners(s), p, q), b = third(corners(t), p, q);
  if (a < 0 || b < 0 || a == b || !beside(a, b).empty()) return {};
  SkinChange change{{s, t}, {{a, p, b}, {b, q, a}}, {}};
  const Vector3d across = (at(q) - at(p)).cross(at(a) - at(b));  // of the quadrilateral, doubled
  for (const Triangle& fresh : change.fresh)
    if (area(fresh).dot(across) <= 0.0) return {};
  change.angle = std::min(angle(change.fresh[0]), angle(change.fresh[1]));
  return change;
}

std::optional<SkinChange> ChangingSkin::contracted(int u, int v) const {
  if (beside(u, v).size() != 2) return {};
  std::set<int> near_u, near_v;
  for (const int t : around(u)) near_u.insert(corners(t).begin(), corners(t).end());
  for (const int t : around(v)) near_v.insert(corners(t).begin(), corners(t).end());
  if (near_u.size() != around(u).size() + 1) return {};  // not one fan
  const auto common = std::ranges::count_if(near_u, [&](int w) { return near_v.contains(w); });
  if (common != 4) return {};  // u, v and the two vertices opposite
  SkinChange change{around(u), {}, {u}};
  change.angle = std::numbers::pi;
  for (const int t : around(u)) {
    if (has(corners(t), v)) continue;
    Triangle fresh = corners(t);
    std::ranges::replace(fresh, u, v);
    change.angle = std::min(change.angle, angle(fresh));
    change.fresh.push_back(fresh);
  }
  return change;
}

bool ChangingSkin::one_parent(const SkinChange& change) const {
  const int parent = skin_.parent[static_cast<size_t>(change.gone[0])];
  return parent != kSeveral && std::ranges::all_of(change.gone, [&](int t) {
           return skin_.parent[static_cast<size_t>(t)] == parent;
         });
}

std::pair<size_t, double> ChangingSkin::nearest(int v, const SkinChange& change) const {
  std::pair<size_t, double> best{0, std::numeric_limits<double>::infinity()};
  for (size_t i = 0; i < change.fresh.size(); ++i) {
    const auto [a, b, c] = change.fresh[i];
    const Vector3d w = closest_weights(at(v), at(a), at(b), at(c));
    const double distance = (w[0] * at(a) + w[1] * at(b) + w[2] * at(c) - at(v)).norm();
    if (distance < best.second) best = {i, distance};
  }
  return best;
}

bool ChangingSkin::stays_near(SkinChange& change, double tolerance) const {
  for (const int t : change.gone) {
    const std::vector<int>& on = left_[static_cast<size_t>(t)];
    change.left.insert(change.left.end(), on.begin(), on.end());
  }
  return std::ranges::all_of(change.left,
                             [&](int v) { return nearest(v, change).second <= tolerance; });
}

void ChangingSkin::apply(const SkinChange& change, std::vector<int>& touched) {
  const int parent =
      one_parent(change) ? skin_.parent[static_cast<size_t>(change.gone[0])] : kSeveral;
  for (const int t : change.gone) {
    const auto index = static_cast<size_t>(t);
    for (const int v : corners(t)) std::erase(around_[static_cast<size_t>(v)], t);
    alive_[index] = false;
    left_[index].clear();
  }
  for (size_t i = 0; i < change.fresh.size(); ++i) {
    const auto t = static_cast<size_t>(change.gone[i]);
    skin_.mesh.triangles[t] = change.fresh[i];
    skin_.parent[t] = parent;
    alive_[t] = true;
    for (const int v : change.fresh[i]) around_[static_cast<size_t>(v)].push_back(change.gone[i]);
  }
  for (const int v : change.left)
    left_[static_cast<size_t>(change.gone[nearest(v, change).first])].push_back(v);
  for (const Triangle& fresh : change.fresh)
    for (const int v : fresh) touched.insert(touched.end(), around(v).begin(), around(v).end());
}

void ChangingSkin::drop_gone() {
  size_t kept = 0;
  for (size_t t = 0; t < skin_.mesh.triangles.size(); ++t) {
    if (!alive_[t]) continue;
    skin_.mesh.triangles[kept] = skin_.mesh.triangles[t];
    skin_.parent[kept++] = skin_.parent[t];
  }
  skin_.mesh.triangles.resize(kept);
  skin_.parent.resize(kept);
}

}  // namespace hookeye::detail
