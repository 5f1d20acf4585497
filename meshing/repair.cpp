// The steps of a repair, in order; what needs CGAL is asked of helpers/repair.cpp.
#include "meshing/repair.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/helper.h"
#include "meshing/detail.h"
#include "meshing/parcels.h"
#include "meshing/skin.h"
#include "meshing/soup.h"
#include "meshing/triangle_tree.h"

namespace hookeye {
namespace {

using Triangle = std::array<int, 3>;

template <class Unpack>
auto ask_cgal(Packer& what, const Place& place, const Unpack& unpack) {
  return ask_helper({.name = "repair",
                     .content = what.take(),
                     .limits = {4.0 * (1 << 30), 300.0},
                     .interruptible = true,
                     .place = place,
                     .right = "a surface that is less broken",
                     .damaged = "CGAL gave up on the surface"},
                    unpack);
}

class Repair {
 public:
  Repair(const SurfaceMesh& surface, const RepairOptions& options, const Place& place)
      : options_(options), place_(place), soup_(surface) {
    if (!std::filesystem::exists(helper_folder() / "repair"))
      throw InputError(place, "this build of hookeye mends no surfaces: it was made without CGAL",
                       "a build where libcgal-dev is installed");
    soup_.uv.clear();
  }

  void clean() {
    tell(detail::drop_repeated(soup_),
         "dropped {} triangles that were there twice or had a corner twice");
    tell(detail::drop_inner_walls(soup_), "dropped {} walls that were there from both sides");
  }

  void close_gaps() {
    tolerance_ = options_.tolerance > 0.0 ? options_.tolerance : usual_tolerance();
    double widest = 0.0;
    const int merged = detail::weld(soup_, tolerance_, widest);
    if (merged > 0)
      said.push_back(fmt::format("merged {} corners over gaps of up to {:.2g} (tolerance {:.2g})",
                                 merged, widest, tolerance_));
    tell(detail::cut_at_corners(soup_, tolerance_),
         "cut {} triangles where a corner of another lay on their open edge");
    clean();
    tell(detail::drop_hanging(soup_), "dropped {} triangles that hung on an edge of two others");
  }

  void orient() {
    Packer what;
    what.put("orient");
    detail::pack(what, soup_);
    bool whole = true;
    const SurfaceMesh turned = ask_cgal(what, place_, [&](Unpacker& from) {
      SurfaceMesh surface = detail::unpack_surface(from);
      from.get(whole);
      return surface;
    });
    size_t count = 0;
    for (size_t t = 0; t < soup_.triangles.size(); ++t)
      count += !same_turn(soup_.triangles[t], turned.triangles[t]);
    count = std::min(count, turned.triangles.size() - count);
    tell(static_cast<int>(count), "turned {} triangles that faced against their neighbours");
    if (!whole)
      said.emplace_back(
          "parted the surface where more than two triangles met at an edge, or parts at a corner");
    soup_ = turned;
  }

  void fill_holes() {
    std::map<std::pair<int, int>, int> beside;
    for (const detail::OpenEdge& e : detail::open_edges(soup_)) {
      const Triangle& t = soup_.triangles[static_cast<size_t>(e.triangle)];
      beside[{e.to, e.from}] = t[0] + t[1] + t[2] - e.from - e.to;
    }
    int filled = 0;
    double longest = 0.0;
    Vector3d at = Vector3d::Zero();
    for (const std::vector<int>& loop : detail::holes(soup_)) {
      const std::vector<Triangle> patch = patch_over(loop, beside);
      if (patch.empty()) continue;
      for (const auto& [i, j, k] : patch)
        soup_.triangles.push_back({loop[static_cast<size_t>(i)], loop[static_cast<size_t>(j)],
                                   loop[static_cast<size_t>(k)]});
      ++filled;
      double around = 0.0;
      for (size_t i = 0; i < loop.size(); ++i)
        around += (soup_.X.col(loop[i]) - soup_.X.col(loop[(i + 1) % loop.size()])).norm();
      if (around > longest) longest = around, at = soup_.X.col(loop[0]);
    }
    if (filled > 0)
      said.push_back(fmt::format("filled {} holes, the longest {:.3g} around, at {}", filled,
                                 longest, detail::where(at)));
  }

  void drop_flat_parts() {
    tell(detail::drop_flat_parts(soup_, tolerance_), "dropped {} parts without volume");
  }

  void mend_intersections() {
    if (intersections().empty()) return;
    const detail::Subdivided skin =
        detail::skin_of(soup_, std::numeric_limits<double>::infinity(), tolerance_);
    if (skin.mesh.triangles != soup_.triangles) {
      said.push_back(
          fmt::format("turned and contracted edges of slivers (tolerance {:.2g})", tolerance_));
      soup_ = skin.mesh;
      soup_.uv.clear();
    }
    refuse_overlaps();
    for (int rings = 0; rings < kMostRings; ++rings) {
      const auto pairs = intersections();
      if (pairs.empty()) return;
      const int out = detail::cut_out(soup_, pairs, rings);
      said.push_back(fmt::format("cut out {} triangles where {} pairs intersected, the first at {}",
                                 out, pairs.size(), detail::where(first_place(pairs))));
      detail::drop_hanging(soup_);
      fill_holes();
      drop_flat_parts();
    }
  }

  void remesh() {
    Packer what;
    what.put("remesh");
    detail::pack(what, soup_);
    what.put(options_.edge);
    const size_t before = soup_.triangles.size();
    soup_ = ask_cgal(what, place_, detail::unpack_surface);
    said.push_back(fmt::format("remeshed to an edge of {:.4g}: {} triangles, {} before",
                               options_.edge, soup_.triangles.size(), before));
  }

  /// Closed parts turned outwards, and cavities inwards, before anything is built on them.
  void finish(const std::string& after, const std::string& right) {
    detail::drop_unused(soup_);
    try {
      MendedSurface mended = mend(soup_, place_);
      soup_ = std::move(mended.surface);
      said.insert(said.end(), mended.said.begin(), mended.said.end());
    } catch (const InputError& error) {
      throw InputError(place_, fmt::format("could not be mended{}: {}", after, error.wrong()),
                       right);
    }
  }

  const SurfaceMesh& surface() const { return soup_; }
  std::vector<std::string> said;

 private:
  static constexpr int kMostRings = 4;

  void tell(int count, fmt::format_string<int&> text) {
    if (count > 0) said.push_back(fmt::format(text, count));
  }

  static bool same_turn(const Triangle& a, const Triangle& b) {
    // Corners that were parted have other numbers at their ends; those that stay tell the turn.
    for (size_t k = 0; k < 3; ++k)
      for (size_t i = 0; i < 3; ++i)
        if (a[k] == b[i] && a[(k + 1) % 3] == b[(i + 2) % 3]) return false;
    return true;
  }

  double usual_tolerance() const {
    double tolerance = 1e-4 * detail::diagonal(soup_.X);
    std::vector<double> lengths;
    for (const detail::OpenEdge& e : detail::open_edges(soup_))
      lengths.push_back((soup_.X.col(e.from) - soup_.X.col(e.to)).norm());
    if (lengths.empty()) return tolerance;
    const auto middle = lengths.begin() + static_cast<long>(lengths.size() / 2);
    std::ranges::nth_element(lengths, middle);
    return std::min(tolerance, 0.1 * *middle);
  }

  std::vector<Triangle> patch_over(const std::vector<int>& loop,
                                   const std::map<std::pair<int, int>, int>& beside) const {
    Matrix3Xd X(3, static_cast<Eigen::Index>(loop.size())), far = X;
    for (size_t i = 0; i < loop.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      X.col(column) = soup_.X.col(loop[i]);
      far.col(column) = soup_.X.col(beside.at({loop[i], loop[(i + 1) % loop.size()]}));
    }
    Packer what;
    what.put("fill").put(X).put(far);
    return ask_cgal(what, place_, [&](Unpacker& from) {
      const auto triangles = from.take<std::vector<Triangle>>();
      for (const Triangle& t : triangles)
        for (const int i : t)
          if (i < 0 || i >= static_cast<int>(loop.size())) throw WireFault();
      return triangles;
    });
  }

  std::vector<std::array<int, 2>> intersections() const {
    return inspect(soup_).self_intersections;
  }

  Vector3d first_place(const std::vector<std::array<int, 2>>& pairs) const {
    return soup_.X.col(soup_.triangles[static_cast<size_t>(pairs[0][0])][0]);
  }

  /// Joining bodies is not for this program: it would take CGAL's exact numbers.
  void refuse_overlaps() const {
    const auto pairs = intersections();
    std::vector<int> part(soup_.triangles.size());
    int count = 0;
    for (const detail::Shell& shell : detail::shells(soup_)) {
      for (const int t : shell.triangles) part[static_cast<size_t>(t)] = count;
      ++count;
    }
    for (const auto& [s, t] : pairs) {
      if (part[static_cast<size_t>(s)] == part[static_cast<size_t>(t)]) continue;
      throw InputError(
          place_,
          fmt::format("two closed parts overlap near {}, and --repair does not join bodies",
                      detail::where(soup_.X.col(soup_.triangles[static_cast<size_t>(t)][0]))),
          "one body, united in the program that made the parts");
    }
  }

  RepairOptions options_;
  Place place_;
  SurfaceMesh soup_;
  double tolerance_ = 0.0;
};

/// Where gaps are wider than the tolerance, triangles that hang together by chance would be closed
/// to small bodies, and the rest would go as flat parts.
void refuse_unless_most_is_left(const SurfaceMesh& before, const SurfaceMesh& now,
                                const Place& place) {
  constexpr double kMost = 0.5;
  const double left = detail::area(now) / std::max(detail::area(before), 1e-300);
  if (left >= kMost) return;
  throw InputError(
      place,
      fmt::format("could not be mended: only {:.0f} % of the surface's area encloses a "
                  "volume",
                  100.0 * left),
      "the surface of a body, or a larger --tolerance where its triangles do not meet");
}

/// NaN of what encloses no volume: triangles that are there twice or intersect do not matter.
double volume_of(const SurfaceMesh& surface) {
  SurfaceMesh once = surface;
  detail::drop_repeated(once);
  const SurfaceFaults faults = inspect(once);
  return faults.open_edges.empty() && faults.crowded_edges.empty() && faults.inverted.empty()
             ? std::abs(detail::six_volume(once)) / 6.0
             : std::nan("");
}

}  // namespace

/// How far the surfaces leave each other: corners of both, and the middles of the old edges. A hole
/// that is remeshed with fewer corners keeps those on the old surface, and cuts across between
/// them. What closes a gap was nowhere before: the middles of the new edges are not asked for.
double detail::apart(const SurfaceMesh& before, const SurfaceMesh& now) {
  if (before.X == now.X && before.triangles == now.triangles) return 0.0;
  double farthest = 0.0;
  const auto measure = [&](const SurfaceMesh& from, const SurfaceMesh& to, bool middles) {
    const detail::TriangleTree tree(to.X, to.triangles);
    const auto ask = [&](const Vector3d& x) {
      farthest = std::max(farthest, tree.nearest(x).distance);
    };
    std::set<int> used;
    for (const std::array<int, 3>& t : from.triangles) used.insert(t.begin(), t.end());
    for (const int v : used) ask(from.X.col(v));
    if (!middles) return;
    for (const std::array<int, 3>& t : from.triangles)
      for (size_t k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (a < b) ask(0.5 * (from.X.col(a) + from.X.col(b)));  // the neighbour has it as (b, a)
      }
  };
  measure(before, now, true);
  measure(now, before, false);
  return farthest;
}

RepairedSurface repair(const SurfaceMesh& surface, const RepairOptions& options,
                       const Place& place) {
  if (surface.triangles.empty())
    throw InputError(place, "the surface has no triangles", "a surface of a body");
  Repair repair(surface, options, place);
  repair.clean();
  repair.close_gaps();
  repair.orient();
  repair.fill_holes();
  repair.drop_flat_parts();
  refuse_unless_most_is_left(surface, repair.surface(), place);
  repair.mend_intersections();
  refuse_unless_most_is_left(surface, repair.surface(), place);
  repair.finish("",
                "a surface that is mended by hand where it is told to be broken, or a larger "
                "--tolerance");
  if (options.edge > 0.0) {
    repair.remesh();
    repair.finish(fmt::format(", as remeshed to an edge of {:.4g}", options.edge),
                  "a smaller --edge, or none for the triangles as they are");
  }
  RepairedSurface out{repair.surface(), repair.said};
  out.volume_before = volume_of(surface);
  out.volume = detail::six_volume(out.surface) / 6.0;
  out.area_before = detail::area(surface), out.area = detail::area(out.surface);
  out.moved = detail::apart(surface, out.surface);
  return out;
}

}  // namespace hookeye
