// The only file that touches TetGen.
#include <fmt/format.h>
#define TETLIBRARY  // as the library was built: faults are thrown, not exits
#include <tetgen.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "meshing/detail.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace detail {

int orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  static const bool ready = [] {
    exactinit(0, 0, 0, 1.0, 1.0, 1.0);
    return true;
  }();
  (void)ready;
  Vector3d p[4] = {a, b, c, d};
  const double det = orient3d(p[0].data(), p[1].data(), p[2].data(), p[3].data());
  return det < 0 ? 1 : det > 0 ? -1 : 0;  // orient3d is positive when d lies below abc
}

}  // namespace detail

namespace {

void hand_over(const SurfaceMesh& surface, tetgenio& in) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(surface.X.cols());
  in.pointlist = new REAL[3 * surface.X.cols()];
  std::copy(surface.X.data(), surface.X.data() + surface.X.size(), in.pointlist);
  in.numberoffacets = static_cast<int>(surface.triangles.size());
  in.facetlist = new tetgenio::facet[in.numberoffacets];
  in.facetmarkerlist = new int[in.numberoffacets];
  for (int t = 0; t < in.numberoffacets; ++t) {
    tetgenio::facet& f = in.facetlist[t];
    tetgenio::init(&f);
    f.numberofpolygons = 1;
    f.polygonlist = new tetgenio::polygon[1];
    tetgenio::init(&f.polygonlist[0]);
    f.polygonlist[0].numberofvertices = 3;
    f.polygonlist[0].vertexlist = new int[3];
    for (int k = 0; k < 3; ++k) f.polygonlist[0].vertexlist[k] = surface.triangles[t][k];
    in.facetmarkerlist[t] = t + 1;  // 0 would mean "none"
  }
}

std::string reason_of(int code) {
  switch (code) {
    case 1:
      return "it ran out of memory";
    case 3:
      return "the surface intersects itself";
    case 4:
      return "the surface has a feature too small to mesh";
    case 5:
      return "two parts of the surface nearly touch";
    default:
      return "it could not recover the surface";
  }
}

[[noreturn]] void refuse(const SurfaceMesh& surface, const std::string& reason,
                         const Place& place) {
  const SurfaceFaults faults = inspect(surface);
  const std::string fault =
      faults.clean() ? "no open edge or self-intersection was found" : faults.describe(surface);
  throw InputError(
      place, fmt::format("the surface could not be filled with tetrahedra: {}; {}", reason, fault),
      "a closed surface that does not intersect itself, without slivers");
}

/// One run of TetGen on `in`; returns its code (0: done).
int run_tetgen(const std::string& switches, tetgenio& in, tetgenio& out) {
  static std::mutex one_at_a_time;  // its predicates keep global state
  const std::lock_guard lock(one_at_a_time);
  std::string text = switches;
  try {
    tetrahedralize(text.data(), &in, &out);
  } catch (int code) {
    return code == 0 ? 2 : code;
  } catch (const std::exception&) {
    return 2;
  }
  return out.numberoftetrahedra > 0 ? 0 : 2;
}

TetMesh taken_back(const tetgenio& out) {
  TetMesh mesh;
  mesh.order = 1;
  mesh.X = Eigen::Map<const Matrix3Xd>(out.pointlist, 3, out.numberofpoints);
  mesh.elements.resize(4, out.numberoftetrahedra);
  for (int e = 0; e < out.numberoftetrahedra; ++e) {
    const int* corner = out.tetrahedronlist + static_cast<ptrdiff_t>(e) * out.numberofcorners;
    for (int k = 0; k < 4; ++k) mesh.elements(k, e) = corner[k];
    const auto x = [&](int k) { return Vector3d(mesh.X.col(mesh.elements(k, e))); };
    if ((x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)) < 0) {
      std::swap(mesh.elements(2, e), mesh.elements(3, e));  // TetGen counts the other way round
    }
  }
  return mesh;
}

/// Drops points that no tetrahedron uses (vertices of the file that no triangle uses).
void drop_unused(TetMesh& mesh) {
  std::vector<int> fresh(mesh.nodes(), -1);
  for (int e = 0; e < mesh.size(); ++e) {
    for (int k = 0; k < 4; ++k) fresh[mesh.elements(k, e)] = 0;
  }
  int n = 0;
  Matrix3Xd X = mesh.X;
  for (int i = 0; i < mesh.nodes(); ++i) {
    if (fresh[i] < 0) continue;
    X.col(n) = mesh.X.col(i);
    fresh[i] = n++;
  }
  mesh.X = X.leftCols(n);
  for (int e = 0; e < mesh.size(); ++e) {
    for (int k = 0; k < 4; ++k) mesh.elements(k, e) = fresh[mesh.elements(k, e)];
  }
}

std::map<std::array<int, 3>, int> markers(const tetgenio& out) {
  std::map<std::array<int, 3>, int> marker_of;
  for (int f = 0; f < out.numberoftrifaces; ++f) {
    std::array<int, 3> c{out.trifacelist[3 * f], out.trifacelist[3 * f + 1],
                         out.trifacelist[3 * f + 2]};
    std::sort(c.begin(), c.end());
    if (out.trifacemarkerlist != nullptr) marker_of[c] = out.trifacemarkerlist[f];
  }
  return marker_of;
}

}  // namespace

TetMesh fill(const SurfaceMesh& surface, const FillOptions& options, const Place& place) {
  const SurfaceFaults faults = inspect(surface);
  if (!faults.clean()) {
    throw InputError(place,
                     fmt::format("the surface does not bound a body: {}", faults.describe(surface)),
                     "a closed surface without self-intersections, triangles turned outwards");
  }
  const double edge = options.edge > 0 ? options.edge : detail::diagonal(surface.X) / 12.0;
  // A regular tetrahedron of this edge; meshes bounded by -a come out at about two thirds of the
  // bound in the mean, hence their mean edge near the target.
  const double volume = edge * edge * edge / (6.0 * std::sqrt(2.0)) * 1.5;
  tetgenio in, out;
  hand_over(surface, in);
  const std::string switches = fmt::format("pq{:.3f}/{:.3f}a{:.17g}Q", options.radius_edge_ratio,
                                           options.min_dihedral_deg, volume);
  const int code = run_tetgen(switches, in, out);
  if (code != 0) refuse(surface, reason_of(code), place);

  TetMesh mesh = taken_back(out);
  find_boundary(mesh);
  const auto marker_of = markers(out);
  mesh.boundary_parent.resize(static_cast<size_t>(mesh.boundary.cols()));
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    std::array<int, 3> c{mesh.boundary(0, f), mesh.boundary(1, f), mesh.boundary(2, f)};
    std::sort(c.begin(), c.end());
    const auto it = marker_of.find(c);
    if (it == marker_of.end() || it->second < 1 ||
        it->second > static_cast<int>(surface.triangles.size())) {
      refuse(surface, "a boundary face lies on no triangle", place);
    }
    mesh.boundary_parent[static_cast<size_t>(f)] = it->second - 1;
  }
  drop_unused(mesh);
  find_boundary(mesh);
  return with_order(mesh, options.order);
}

}  // namespace hookeye
