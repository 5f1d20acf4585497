// What CGAL does for the family of surfaces (README.md): `rock` makes some, `opinion` judges all.
// The judgement shares nothing with the program: its own reader, exact predicates of its own.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/convex_hull_3.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = std::array<int, 3>;

struct Surface {
  std::vector<Point> points;
  std::vector<Triangle> triangles;
  Kernel::Triangle_3 at(int t) const {
    const auto& [a, b, c] = triangles[static_cast<size_t>(t)];
    return {points[static_cast<size_t>(a)], points[static_cast<size_t>(b)],
            points[static_cast<size_t>(c)]};
  }
};

/// Corners at equal positions are one; triangles with a corner twice, or that are there once more
/// and turned alike, are left out.
Surface read(const std::string& file) {
  std::vector<Point> points;
  std::vector<std::vector<size_t>> polygons;
  const bool read = file.ends_with(".stl")   ? CGAL::IO::read_STL(file, points, polygons)
                    : file.ends_with(".obj") ? CGAL::IO::read_OBJ(file, points, polygons)
                                             : CGAL::IO::read_PLY(file, points, polygons);
  if (!read) {
    std::fprintf(stderr, "%s: CGAL does not read it\n", file.c_str());
    std::exit(2);
  }
  Surface out;
  std::map<Point, int> number;
  std::set<Triangle> seen;
  for (const auto& polygon : polygons) {
    Triangle t{};
    for (size_t k = 0; k < 3; ++k) {
      const Point& p = points[polygon[k]];
      const auto [at, fresh] = number.try_emplace(p, static_cast<int>(out.points.size()));
      if (fresh) out.points.push_back(p);
      t[k] = at->second;
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0] && seen.insert(t).second)
      out.triangles.push_back(t);
  }
  return out;
}

/// How deep the corners of one triangle go through the plane of the other, on the lesser side.
double depth(const Kernel::Triangle_3& one, const Kernel::Triangle_3& two) {
  const Kernel::Vector_3 n = CGAL::cross_product(one[1] - one[0], one[2] - one[0]);
  const double length = std::sqrt(n.squared_length());
  double above = 0.0, below = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double d = length > 0.0 ? (two[k] - one[0]) * n / length : 0.0;
    above = std::max(above, d), below = std::max(below, -d);
  }
  return std::min(above, below);
}

/// The triangles share more than their common corners.
bool cross(const Surface& s, int i, int j) {
  std::vector<int> common;
  const Triangle &a = s.triangles[static_cast<size_t>(i)], &b = s.triangles[static_cast<size_t>(j)];
  for (const int v : a)
    if (std::find(b.begin(), b.end(), v) != b.end()) common.push_back(v);
  const Kernel::Triangle_3 ta = s.at(i), tb = s.at(j);
  if (ta.is_degenerate() || tb.is_degenerate() || common.size() == 3) return false;
  if (common.empty()) return CGAL::do_intersect(ta, tb);
  const auto point = [&](int v) { return s.points[static_cast<size_t>(v)]; };
  if (common.size() == 1) {
    const auto opposite = [&](const Triangle& t) {
      std::vector<Point> ends;
      for (const int v : t)
        if (v != common[0]) ends.push_back(point(v));
      return Kernel::Segment_3(ends[0], ends[1]);
    };
    return CGAL::do_intersect(opposite(a), tb) || CGAL::do_intersect(opposite(b), ta);
  }
  const auto third = [&](const Triangle& t) {
    return point(t[0] + t[1] + t[2] - common[0] - common[1]);
  };
  const Point p = point(common[0]), q = point(common[1]), x = third(a), y = third(b);
  return CGAL::coplanar(p, q, x, y) && CGAL::coplanar_orientation(p, q, x, y) == CGAL::POSITIVE;
}

std::vector<std::array<int, 2>> crossings(const Surface& s) {
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;
  std::vector<Box> boxes;
  for (int t = 0; t < static_cast<int>(s.triangles.size()); ++t)
    boxes.emplace_back(s.at(t).bbox(), t);
  std::vector<std::array<int, 2>> pairs;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    if (cross(s, a.info(), b.info()))
      pairs.push_back({std::min(a.info(), b.info()), std::max(a.info(), b.info())});
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void print(const Point& p) { std::printf("[%.9g,%.9g,%.9g]", p.x(), p.y(), p.z()); }

/// One line of JSON: what is wrong with the surface, with the places.
void opinion(const std::string& file) {
  const Surface s = read(file);
  std::map<std::pair<int, int>, std::array<int, 2>> uses;  // forward, backward
  double volume = 0.0, largest = 0.0;
  for (const Triangle& t : s.triangles) {
    const auto at = [&](size_t k) { return s.points[static_cast<size_t>(t[k])]; };
    volume += CGAL::volume(s.points[0], at(0), at(1), at(2));
    for (size_t k = 0; k < 3; ++k)
      ++uses[std::minmax(t[k], t[(k + 1) % 3])][t[k] < t[(k + 1) % 3] ? 0 : 1];
  }
  for (const Point& p : s.points)
    largest = std::max({largest, std::abs(p.x()), std::abs(p.y()), std::abs(p.z())});
  std::printf("{\"triangles\":%zu,\"volume\":%.9g,\"largest\":%.9g,\"bad_edges\":[",
              s.triangles.size(), volume, largest);
  bool first = true;
  for (const auto& [edge, count] : uses) {
    if (count[0] == 1 && count[1] == 1) continue;
    const char* kind = count[0] + count[1] == 1   ? "open"
                       : count[0] + count[1] == 2 ? "turned"
                                                  : "crowded";
    std::printf("%s[\"%s\",", first ? "" : ",", kind);
    print(s.points[static_cast<size_t>(edge.first)]);
    std::printf(",");
    print(s.points[static_cast<size_t>(edge.second)]);
    std::printf("]");
    first = false;
  }
  std::printf("],\"crossings\":[");
  first = true;
  for (const auto& [i, j] : crossings(s)) {
    const Kernel::Triangle_3 a = s.at(i), b = s.at(j);
    std::printf("%s[%.3g", first ? "" : ",", std::min(depth(a, b), depth(b, a)));
    for (const auto& t : {a, b})
      for (int k = 0; k < 3; ++k) std::printf(","), print(t[k]);
    std::printf("]");
    first = false;
  }
  std::printf("]}\n");
}

/// The hull of random points in a box, as STL.
void rock(int count, unsigned seed, const double* size) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    double x[3], length = 0.0;
    for (double& c : x) c = normal(random), length += c * c;
    for (int k = 0; k < 3; ++k) x[k] *= size[k] / std::sqrt(length);
    points.emplace_back(x[0], x[1], x[2]);
  }
  CGAL::Surface_mesh<Point> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  std::printf("solid rock\n");
  for (const auto f : hull.faces()) {
    std::printf("facet normal 0 0 0\nouter loop\n");
    for (const auto v : CGAL::vertices_around_face(hull.halfedge(f), hull)) {
      const Point& p = hull.point(v);
      std::printf("vertex %.9g %.9g %.9g\n", p.x(), p.y(), p.z());
    }
    std::printf("endloop\nendfacet\n");
  }
  std::printf("endsolid rock\n");
}

}  // namespace

int main(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "";
  if (verb == "opinion" && argc == 3) {
    opinion(argv[2]);
    return 0;
  }
  if (verb == "rock" && argc == 7) {
    const double size[3] = {std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6])};
    rock(std::atoi(argv[2]), static_cast<unsigned>(std::atoi(argv[3])), size);
    return 0;
  }
  std::fprintf(stderr, "cgal opinion SURFACE | cgal rock POINTS SEED A B C\n");
  return 2;
}
