// What can be mended of a surface without guessing.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "meshing/detail.h"
#include "meshing/skin.h"

namespace hookeye {
namespace {

using Triangle = std::array<int, 3>;

bool has_a_corner_twice(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// Triangles without area that have three corners: one of them lies on the edge between the others.
/// Dropped they would leave a crack, so the neighbour beyond that edge is cut there instead.
class FlatTriangles {
 public:
  explicit FlatTriangles(MendedSurface& s) : s_(s) {}

  /// Number of those that are gone.
  int mend(std::vector<int> flat) {
    const size_t before = flat.size();
    for (int pass = 0; pass < kPasses && !flat.empty(); ++pass) {
      find_edges();
      changed_.clear();
      for (const int t : flat) cut_neighbour(t);
      if (changed_.empty()) break;
      flat = inspect(s_.surface).degenerate;
    }
    return static_cast<int>(before) - static_cast<int>(flat.size());
  }

 private:
  static constexpr int kPasses = 50;  ///< one for each flat triangle in a row of them

  void find_edges() {
    beside_.clear();
    for (int t = 0; t < static_cast<int>(s_.surface.triangles.size()); ++t)
      for (size_t k = 0; k < 3; ++k) {
        const Triangle& c = s_.surface.triangles[static_cast<size_t>(t)];
        beside_[std::minmax(c[k], c[(k + 1) % 3])].push_back(t);
      }
  }

  void cut_neighbour(int t) {
    auto& triangles = s_.surface.triangles;
    const auto at = [&](int v) { return Vector3d(s_.surface.X.col(v)); };
    const Triangle c = triangles[static_cast<size_t>(t)];
    size_t k = 0;  // pq is the longest edge, a lies on it
    for (size_t i = 1; i < 3; ++i)
      if ((at(c[i]) - at(c[(i + 1) % 3])).norm() > (at(c[k]) - at(c[(k + 1) % 3])).norm()) k = i;
    const int p = c[k], q = c[(k + 1) % 3], a = c[(k + 2) % 3];
    const std::vector<int>& both = beside_[std::minmax(p, q)];
    if (both.size() != 2) return;
    const int n = both[0] == t ? both[1] : both[0];
    if (changed_.contains(t) || changed_.contains(n)) return;
    const Triangle other = triangles[static_cast<size_t>(n)];
    const size_t from = static_cast<size_t>(std::ranges::find(other, q) - other.begin());
    const int b = other[(from + 2) % 3];
    if (other[(from + 1) % 3] != p || b == a || beside_.contains(std::minmax(a, b))) return;
    triangles[static_cast<size_t>(t)] = {a, p, b};
    triangles[static_cast<size_t>(n)] = {b, q, a};
    s_.file_triangle[static_cast<size_t>(t)] = s_.file_triangle[static_cast<size_t>(n)];
    changed_.insert({t, n});
    if (s_.surface.uv.empty()) return;
    const auto uv = s_.surface.uv[static_cast<size_t>(n)];
    const Vector2d uv_q = uv[from], uv_p = uv[(from + 1) % 3], uv_b = uv[(from + 2) % 3];
    const double share = (at(a) - at(p)).norm() / (at(q) - at(p)).norm();
    const Vector2d uv_a = (1.0 - share) * uv_p + share * uv_q;
    s_.surface.uv[static_cast<size_t>(t)] = {uv_a, uv_p, uv_b};
    s_.surface.uv[static_cast<size_t>(n)] = {uv_b, uv_q, uv_a};
  }

  MendedSurface& s_;
  std::map<std::pair<int, int>, std::vector<int>> beside_;
  std::set<int> changed_;
};

void drop(MendedSurface& s, const std::vector<int>& triangles, const std::string& what) {
  if (triangles.empty()) return;
  const int first = s.file_triangle[static_cast<size_t>(triangles[0])];
  s.said.push_back(
      fmt::format("dropped {} triangles {}, the first being {}", triangles.size(), what, first));
  const std::set<int> gone(triangles.begin(), triangles.end());
  size_t kept = 0;
  for (size_t t = 0; t < s.surface.triangles.size(); ++t) {
    if (gone.contains(static_cast<int>(t))) continue;
    s.surface.triangles[kept] = s.surface.triangles[t];
    if (!s.surface.uv.empty()) s.surface.uv[kept] = s.surface.uv[t];
    s.file_triangle[kept++] = s.file_triangle[t];
  }
  s.surface.triangles.resize(kept);
  if (!s.surface.uv.empty()) s.surface.uv.resize(kept);
  s.file_triangle.resize(kept);
}

void mend_degenerate(MendedSurface& s, const SurfaceFaults& faults) {
  std::vector<int> twice, flat;
  for (const int t : faults.degenerate)
    (has_a_corner_twice(s.surface.triangles[static_cast<size_t>(t)]) ? twice : flat).push_back(t);
  if (!flat.empty()) {
    const int first = flat[0], cut = FlatTriangles(s).mend(flat);
    if (cut > 0)
      s.said.push_back(fmt::format(
          "{} triangles without area, the first being {}, lay along an edge of their neighbours, "
          "which were cut there",
          cut, first));
  }
  twice = inspect(s.surface).degenerate;
  drop(s, twice, "without area");
}

/// Whether the intersections go away with what rounding may have moved.
bool only_rounding(const SurfaceMesh& surface) {
  const detail::Subdivided skin =
      detail::skin_of(surface, std::numeric_limits<double>::infinity(), detail::rounding(surface));
  return inspect(skin.mesh).clean();
}

}  // namespace

double detail::rounding(const SurfaceMesh& surface) {
  return std::min(1e-5 * surface.X.cwiseAbs().maxCoeff(), 1e-4 * diagonal(surface.X));
}

MendedSurface mend(const SurfaceMesh& surface, const Place& place) {
  MendedSurface out{surface, {}, {}};
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t)
    out.file_triangle.push_back(t);
  SurfaceFaults faults = inspect(surface);
  if (!faults.degenerate.empty()) {
    mend_degenerate(out, faults);
    faults = inspect(out.surface);
  }
  if (!faults.duplicated.empty()) {
    drop(out, faults.duplicated, "that were there twice");
    faults = inspect(out.surface);
  }
  if (out.surface.triangles.empty()) {
    throw InputError(place, "the surface has no triangle with an area", "a closed surface");
  }
  if (faults.inside_out) {
    const std::vector<int> turned = detail::inside_out(out.surface);
    for (const int t : turned) {
      std::swap(out.surface.triangles[static_cast<size_t>(t)][1],
                out.surface.triangles[static_cast<size_t>(t)][2]);
      if (!out.surface.uv.empty())
        std::swap(out.surface.uv[static_cast<size_t>(t)][1],
                  out.surface.uv[static_cast<size_t>(t)][2]);
    }
    out.said.emplace_back(
        turned.size() == out.surface.triangles.size()
            ? "turned the surface, whose triangles all faced inwards"
            : fmt::format("turned {} triangles of closed parts that faced inwards", turned.size()));
    faults.inside_out = false;
  }
  if (!faults.self_intersections.empty()) {
    SurfaceFaults others = faults;
    others.self_intersections.clear();
    if (others.clean() && only_rounding(out.surface)) {
      out.said.push_back(fmt::format(
          "{} pairs of triangles cross by no more than rounding: the mesh passes them by",
          faults.self_intersections.size()));
      faults = others;
    }
  }
  if (!faults.clean()) throw detail::no_body(out.surface, faults, place);
  detail::refuse_shells_within(out.surface, place);
  return out;
}

}  // namespace hookeye
