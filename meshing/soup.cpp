#include "meshing/soup.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "meshing/detail.h"

namespace hookeye::detail {
namespace {

using Triangle = std::array<int, 3>;
using Edge = std::pair<int, int>;

Edge edge_of(const Triangle& t, size_t k) { return std::minmax(t[k], t[(k + 1) % 3]); }

std::map<Edge, int> uses(const SurfaceMesh& soup) {
  std::map<Edge, int> count;
  for (const Triangle& t : soup.triangles)
    for (size_t k = 0; k < 3; ++k) ++count[edge_of(t, k)];
  return count;
}

int drop(SurfaceMesh& soup, const std::vector<bool>& gone) {
  size_t kept = 0;
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    if (!gone[t]) soup.triangles[kept++] = soup.triangles[t];
  const size_t dropped = soup.triangles.size() - kept;
  soup.triangles.resize(kept);
  return static_cast<int>(dropped);
}

Triangle sorted(Triangle t) {
  std::ranges::sort(t);
  return t;
}

/// Whether the corners come in an even permutation of their order by number.
bool even(const Triangle& t) {
  const size_t least = static_cast<size_t>(std::ranges::min_element(t) - t.begin());
  return t[(least + 1) % 3] < t[(least + 2) % 3];
}

using Cell = std::array<long, 3>;

/// Points in cubes of a size, to find those near a place.
class Grid {
 public:
  explicit Grid(double size) : size_(size) {}
  void add(const Vector3d& x, int v) { cells_[cell(x)].push_back(v); }

  template <class Visit>
  void near(const Vector3d& low, const Vector3d& high, const Visit& visit) const {
    const Cell first = cell(low), last = cell(high);
    Cell c = first;
    for (c[0] = first[0]; c[0] <= last[0]; ++c[0])
      for (c[1] = first[1]; c[1] <= last[1]; ++c[1])
        for (c[2] = first[2]; c[2] <= last[2]; ++c[2])
          if (const auto at = cells_.find(c); at != cells_.end())
            for (const int v : at->second) visit(v);
  }

 private:
  Cell cell(const Vector3d& x) const {
    Cell c;
    for (size_t k = 0; k < 3; ++k)
      c[k] = std::lround(std::floor(x[static_cast<Eigen::Index>(k)] / size_));
    return c;
  }
  double size_;
  std::map<Cell, std::vector<int>> cells_;
};

std::set<int> corners_of(const std::vector<OpenEdge>& edges) {
  std::set<int> corners;
  for (const OpenEdge& e : edges) corners.insert({e.from, e.to});
  return corners;
}

}  // namespace

std::vector<OpenEdge> open_edges(const SurfaceMesh& soup) {
  const std::map<Edge, int> count = uses(soup);
  std::vector<OpenEdge> open;
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    for (size_t k = 0; k < 3; ++k) {
      const Triangle& c = soup.triangles[t];
      if (count.at(edge_of(c, k)) == 1) open.push_back({c[k], c[(k + 1) % 3], static_cast<int>(t)});
    }
  return open;
}

int drop_repeated(SurfaceMesh& soup) {
  std::set<std::pair<Triangle, bool>> seen;
  std::vector<bool> gone;
  for (const Triangle& t : soup.triangles) {
    const Triangle c = sorted(t);
    gone.push_back(c[0] == c[1] || c[1] == c[2] || !seen.insert({c, even(t)}).second);
  }
  return drop(soup, gone);
}

int drop_inner_walls(SurfaceMesh& soup) {
  std::map<Triangle, std::vector<size_t>> by_corners;
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    by_corners[sorted(soup.triangles[t])].push_back(t);
  std::vector<bool> gone(soup.triangles.size(), false);
  for (const auto& [corners, same] : by_corners)
    if (same.size() == 2) gone[same[0]] = gone[same[1]] = true;
  return drop(soup, gone) / 2;
}

int drop_hanging(SurfaceMesh& soup) {
  int all = 0;
  while (true) {
    const std::map<Edge, int> count = uses(soup);
    std::vector<bool> gone;
    for (const Triangle& t : soup.triangles) {
      bool open = false, crowded = false;
      for (size_t k = 0; k < 3; ++k) {
        open = open || count.at(edge_of(t, k)) == 1;
        crowded = crowded || count.at(edge_of(t, k)) > 2;
      }
      gone.push_back(open && crowded);
    }
    const int dropped = drop(soup, gone);
    if (dropped == 0) return all;
    all += dropped;
  }
}

int drop_flat_parts(SurfaceMesh& soup, double thickness) {
  std::vector<bool> gone(soup.triangles.size(), false);
  int parts = 0;
  for (const Shell& shell : shells(soup)) {
    double twice_area = 0.0;
    for (const int t : shell.triangles) {
      const auto& [a, b, c] = soup.triangles[static_cast<size_t>(t)];
      const Vector3d x = soup.X.col(a), y = soup.X.col(b), z = soup.X.col(c);
      twice_area += (y - x).cross(z - x).norm();
    }
    if (std::abs(shell.six_volume) / 6.0 > 0.5 * thickness * 0.5 * twice_area) continue;
    for (const int t : shell.triangles) gone[static_cast<size_t>(t)] = true;
    ++parts;
  }
  drop(soup, gone);
  return parts;
}

int weld(SurfaceMesh& soup, double tolerance, double& widest) {
  std::map<int, int> first;
  const auto root = [&](int v) {
    while (first.at(v) != v) v = first.at(v);
    return v;
  };
  Grid grid(tolerance);
  int merged = 0;
  for (const int v : corners_of(open_edges(soup))) {
    const Vector3d x = soup.X.col(v);
    first[v] = v;
    grid.near(x.array() - tolerance, x.array() + tolerance, [&](int w) {
      const double distance = (x - soup.X.col(w)).norm();
      const int a = root(v), b = root(w);
      if (distance > tolerance || a == b) return;
      first[std::max(a, b)] = std::min(a, b);
      widest = std::max(widest, distance);
      ++merged;
    });
    grid.add(x, v);
  }
  for (Triangle& t : soup.triangles)
    for (int& v : t)
      if (first.contains(v)) v = root(v);
  return merged;
}

int cut_at_corners(SurfaceMesh& soup, double tolerance) {
  int cut = 0;
  for (int pass = 0; pass < 3; ++pass) {  // a triangle is cut along one edge in a pass
    const std::vector<OpenEdge> open = open_edges(soup);
    double longest = 0.0;
    for (const OpenEdge& e : open)
      longest = std::max(longest, (soup.X.col(e.from) - soup.X.col(e.to)).norm());
    if (longest == 0.0) return cut;
    Grid grid(longest);
    for (const int v : corners_of(open)) grid.add(soup.X.col(v), v);
    std::set<int> changed;
    for (const OpenEdge& e : open) {
      if (changed.contains(e.triangle)) continue;
      const Vector3d a = soup.X.col(e.from), b = soup.X.col(e.to), along = b - a;
      std::vector<std::pair<double, int>> between;
      grid.near(a.cwiseMin(b).array() - tolerance, a.cwiseMax(b).array() + tolerance, [&](int v) {
        const Vector3d x = soup.X.col(v);
        const double share = (x - a).dot(along) / along.squaredNorm();
        const bool inside =
            share > 0.0 && share < 1.0 && (x - a).norm() > tolerance && (x - b).norm() > tolerance;
        if (inside && (a + share * along - x).norm() <= tolerance) between.emplace_back(share, v);
      });
      const Triangle t = soup.triangles[static_cast<size_t>(e.triangle)];
      std::erase_if(between, [&](const auto& one) { return std::ranges::count(t, one.second); });
      if (between.empty()) continue;
      std::ranges::sort(between);
      const int apex = t[0] + t[1] + t[2] - e.from - e.to;
      int from = e.from;
      soup.triangles[static_cast<size_t>(e.triangle)] = {between.back().second, e.to, apex};
      for (const auto& [share, v] : between) {
        soup.triangles.push_back({from, v, apex});
        from = v;
      }
      changed.insert(e.triangle);
      ++cut;
    }
    if (changed.empty()) return cut;
  }
  return cut;
}

std::vector<std::vector<int>> holes(const SurfaceMesh& soup) {
  std::multimap<int, int> next;  // against the triangles' direction
  for (const OpenEdge& e : open_edges(soup)) next.emplace(e.to, e.from);
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int> path{next.begin()->first};
    while (true) {
      const auto step = next.find(path.back());
      if (step == next.end()) break;  // not turned alike: no loop
      const int to = step->second;
      next.erase(step);
      const auto before = std::ranges::find(path, to);
      if (before == path.end()) {
        path.push_back(to);
        continue;
      }
      loops.emplace_back(before, path.end());
      path.erase(before + 1, path.end());
    }
  }
  return loops;
}

int cut_out(SurfaceMesh& soup, const std::vector<std::array<int, 2>>& pairs, int rings) {
  std::vector<bool> gone(soup.triangles.size(), false);
  for (const auto& [s, t] : pairs)
    gone[static_cast<size_t>(s)] = gone[static_cast<size_t>(t)] = true;
  for (int ring = 0; ring < rings; ++ring) {
    std::set<int> corners;
    for (size_t t = 0; t < gone.size(); ++t)
      if (gone[t]) corners.insert(soup.triangles[t].begin(), soup.triangles[t].end());
    for (size_t t = 0; t < gone.size(); ++t)
      for (const int v : soup.triangles[t]) gone[t] = gone[t] || corners.contains(v);
  }
  return drop(soup, gone);
}

void drop_unused(SurfaceMesh& soup) {
  std::vector<int> fresh(static_cast<size_t>(soup.X.cols()), -1);
  for (const Triangle& t : soup.triangles)
    for (const int v : t) fresh[static_cast<size_t>(v)] = 0;
  int kept = 0;
  for (size_t v = 0; v < fresh.size(); ++v) {
    if (fresh[v] < 0) continue;
    soup.X.col(kept) = soup.X.col(static_cast<Eigen::Index>(v)).eval();
    fresh[v] = kept++;
  }
  soup.X.conservativeResize(3, kept);
  for (Triangle& t : soup.triangles)
    for (int& v : t) v = fresh[static_cast<size_t>(v)];
}

}  // namespace hookeye::detail
