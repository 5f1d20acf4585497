// The only file that touches TetGen.
#include <fmt/format.h>
#include <unistd.h>
#define TETLIBRARY  // as the library was built: faults are thrown, not exits
#include <tetgen.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <map>

#include "meshing/detail.h"
#include "meshing/subdivide.h"
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

void hand_over(const detail::Subdivided& skin, tetgenio& in) {
  const SurfaceMesh& surface = skin.mesh;
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
    in.facetmarkerlist[t] = skin.parent[t] + 1;  // 0 would mean "none"
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

/// What is used of TetGen's output.
struct Filled {
  std::vector<double> points;           ///< 3 each
  std::vector<int> corners;             ///< 4 a tetrahedron
  std::vector<int> triangles, markers;  ///< 3 and 1 a face
};

template <class T>
void send(int pipe, const T* data, size_t n) {
  const uint64_t count = n;
  const auto write_all = [pipe](const void* from, size_t bytes) {
    const char* at = static_cast<const char*>(from);
    while (bytes > 0) {
      const ssize_t done = write(pipe, at, bytes);
      if (done <= 0) _exit(1);
      at += done;
      bytes -= static_cast<size_t>(done);
    }
  };
  write_all(&count, sizeof count);
  write_all(data, n * sizeof(T));
}

template <class T>
bool receive(int pipe, std::vector<T>& data) {
  const auto read_all = [pipe](void* to, size_t bytes) {
    char* at = static_cast<char*>(to);
    while (bytes > 0) {
      const ssize_t done = read(pipe, at, bytes);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) return false;
      at += done;
      bytes -= static_cast<size_t>(done);
    }
    return true;
  };
  uint64_t count = 0;
  if (!read_all(&count, sizeof count)) return false;
  data.resize(count);
  return read_all(data.data(), count * sizeof(T));
}

/// In the child: mesh, send, end.
[[noreturn]] void child(int pipe, std::string switches, tetgenio& in) {
  detail::die_quietly();
  tetgenio out;
  try {
    tetrahedralize(switches.data(), &in, &out);
  } catch (...) {
    _exit(1);
  }
  if (out.numberoftetrahedra == 0 || out.numberofcorners != 4) _exit(1);
  send(pipe, out.pointlist, 3 * static_cast<size_t>(out.numberofpoints));
  send(pipe, out.tetrahedronlist, 4 * static_cast<size_t>(out.numberoftetrahedra));
  const size_t faces = out.trifacemarkerlist == nullptr ? 0 : out.numberoftrifaces;
  send(pipe, out.trifacelist, 3 * faces);
  send(pipe, out.trifacemarkerlist, faces);
  _exit(0);
}

/// One run of TetGen, in a process of its own: when it gives up it frees its memory, throws, and
/// frees it again while the exception passes, which ends the process. False: it gave up.
bool run_tetgen(const std::string& switches, tetgenio& in, Filled& out) {
  int ends[2];
  if (pipe(ends) != 0) return false;
  const pid_t process = fork();
  if (process == 0) {
    close(ends[0]);
    child(ends[1], switches, in);
  }
  close(ends[1]);
  const bool whole = process > 0 && receive(ends[0], out.points) && receive(ends[0], out.corners) &&
                     receive(ends[0], out.triangles) && receive(ends[0], out.markers);
  close(ends[0]);
  return detail::ended_well(process) && whole;
}

TetMesh taken_back(const Filled& out) {
  TetMesh mesh;
  mesh.order = 1;
  mesh.X = Eigen::Map<const Matrix3Xd>(out.points.data(), 3,
                                       static_cast<Eigen::Index>(out.points.size() / 3));
  mesh.elements = Eigen::Map<const Eigen::MatrixXi>(
      out.corners.data(), 4, static_cast<Eigen::Index>(out.corners.size() / 4));
  for (int e = 0; e < mesh.size(); ++e) {
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

std::map<std::array<int, 3>, int> markers(const Filled& out) {
  std::map<std::array<int, 3>, int> marker_of;
  for (size_t f = 0; f < out.markers.size(); ++f) {
    std::array<int, 3> c{out.triangles[3 * f], out.triangles[3 * f + 1], out.triangles[3 * f + 2]};
    std::sort(c.begin(), c.end());
    marker_of[c] = out.markers[f];
  }
  return marker_of;
}

/// Beyond that a factorization takes tens of GB.
constexpr double kMostTetrahedra = 1e6;

void refuse_too_fine(const SurfaceMesh& surface, double edge, const Place& place) {
  double enclosed = 0;
  for (const auto& t : surface.triangles)
    enclosed += surface.X.col(t[0]).dot(surface.X.col(t[1]).cross(surface.X.col(t[2]))) / 6.0;
  const double count = enclosed / (edge * edge * edge / (6.0 * std::sqrt(2.0)));
  if (count <= kMostTetrahedra) return;
  throw InputError(
      place,
      fmt::format("an edge of {:.4g} would take about {:.2g} million tetrahedra", edge,
                  count / 1e6),
      fmt::format("an edge of at least {:.2g}", 1.05 * edge * std::cbrt(count / kMostTetrahedra)));
}

}  // namespace

TetMesh fill(const SurfaceMesh& surface, const FillOptions& options, const Place& place) {
  if (surface.triangles.empty()) {
    throw InputError(place, "the surface has no triangles", "a closed surface");
  }
  const SurfaceFaults faults = inspect(surface);
  if (!faults.clean()) {
    throw InputError(place,
                     fmt::format("the surface does not bound a body: {}", faults.describe(surface)),
                     "a closed surface without self-intersections, triangles turned outwards");
  }
  const double edge = options.edge > 0 ? options.edge : detail::diagonal(surface.X) / 12.0;
  refuse_too_fine(surface, edge, place);
  // TetGen refines a boundary by bisecting every segment of it until quality is met, which makes
  // five to ten times more elements than asked for. So the surface is cut to the target edge here
  // and kept (-Y). Edges come out at 0.7 to 1.4 of the target, their mean near it.
  const detail::Subdivided skin = detail::subdivide(surface, 1.4 * edge);
  // Bounded by -a, volumes come out at about two thirds of the bound: hence 1.5 times the volume of
  // the regular tetrahedron.
  const double volume = 1.5 * edge * edge * edge / (6.0 * std::sqrt(2.0));
  const std::string quality_bounds = fmt::format(
      "q{:.3f}/{:.3f}a{:.17g}Q", options.radius_edge_ratio, options.min_dihedral_deg, volume);
  tetgenio in;
  hand_over(skin, in);
  const std::vector<Vector3d> holes = detail::cavities(surface);
  in.numberofholes = static_cast<int>(holes.size());
  in.holelist = new REAL[3 * holes.size()];
  for (size_t i = 0; i < holes.size(); ++i) Eigen::Map<Vector3d>(in.holelist + 3 * i) = holes[i];
  Filled out;
  if (!run_tetgen("pY" + quality_bounds, in, out)) {
    out = Filled();  // then with points on the boundary
    if (!run_tetgen("p" + quality_bounds, in, out)) refuse(surface, "TetGen gave up", place);
  }

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
