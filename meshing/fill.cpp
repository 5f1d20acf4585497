// The only file that touches TetGen.
#include <fmt/format.h>
#include <unistd.h>
#define TETLIBRARY  // as the library was built: faults are thrown, not exits
#include <tetgen.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "meshing/detail.h"
#include "meshing/subdivide.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace detail {

int orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  // Without the static filter, whose bound counts on a largest coordinate: beyond it the sign would
  // be taken from rounding.
  static const bool ready = [] {
    exactinit(0, 0, 1, 1.0, 1.0, 1.0);
    return true;
  }();
  (void)ready;
  Vector3d p[4] = {a, b, c, d};
  const double det = orient3d(p[0].data(), p[1].data(), p[2].data(), p[3].data());
  return det < 0 ? 1 : det > 0 ? -1 : 0;  // orient3d is positive when d lies below abc
}

}  // namespace detail

namespace {

/// Where TetGen sees the body: near the origin and of size one, so that neither its place nor its
/// unit of length matters. Unturned, both ways are exact for vertices: the scale is a power of two,
/// and a coordinate is moved only where it lies so far out that the difference needs no rounding.
class UnitFrame {
 public:
  UnitFrame(const Matrix3Xd& X, const Eigen::Matrix3d& turn) : turn_(turn) {
    const Vector3d low = X.rowwise().minCoeff(), high = X.rowwise().maxCoeff();
    const Vector3d middle = 0.5 * (low + high), size = high - low;
    for (int k = 0; k < 3; ++k)
      if (std::abs(middle[k]) >= size[k]) shift_[k] = middle[k];  // x / middle is in [1/2, 2]
    scale_ = std::exp2(-std::ilogb(std::max(size.maxCoeff(), std::numeric_limits<double>::min())));
  }
  Vector3d in(const Vector3d& x) const { return turn_ * (scale_ * (x - shift_)); }
  Vector3d out(const Vector3d& x) const { return turn_.transpose() * x / scale_ + shift_; }
  double length_in(double length) const { return scale_ * length; }

 private:
  Eigen::Matrix3d turn_;
  Vector3d shift_ = Vector3d::Zero();
  double scale_ = 1.0;
};

void hand_over(const detail::Subdivided& skin, const UnitFrame& frame, tetgenio& in) {
  const SurfaceMesh& surface = skin.mesh;
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(surface.X.cols());
  in.pointlist = new REAL[3 * surface.X.cols()];
  for (Eigen::Index i = 0; i < surface.X.cols(); ++i)
    Eigen::Map<Vector3d>(in.pointlist + 3 * i) = frame.in(surface.X.col(i));
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

/// TetGen's points begin with those of the skin, which keep their places to the last bit.
TetMesh taken_back(const Filled& out, const UnitFrame& frame, const SurfaceMesh& skin) {
  TetMesh mesh;
  mesh.order = 1;
  mesh.X.resize(3, static_cast<Eigen::Index>(out.points.size() / 3));
  for (Eigen::Index i = 0; i < mesh.X.cols(); ++i)
    mesh.X.col(i) = i < skin.X.cols() ? Vector3d(skin.X.col(i))
                                      : frame.out(Vector3d::Map(out.points.data() + 3 * i));
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

struct Attempt {
  Filled out;  ///< empty: TetGen gave up
  UnitFrame frame;
};

/// TetGen gives up on about one body in a hundred because of the way in which points happen to be
/// rounded; turned a little it takes the same one.
Attempt filled(const detail::Subdivided& skin, const std::vector<Vector3d>& holes,
               const FillOptions& options, double edge) {
  const Eigen::Matrix3d unturned = Eigen::Matrix3d::Identity();
  const auto turned = [](double angle, const Vector3d& about) -> Eigen::Matrix3d {
    return Eigen::AngleAxisd(angle, about.normalized()).toRotationMatrix();
  };
  const std::array<std::pair<Eigen::Matrix3d, const char*>, 4> ways{{
      {unturned, "pY"},
      {turned(0.7, {1, 2, 3}), "pY"},
      {turned(1.1, {-3, 1, 2}), "pY"},
      {unturned, "p"},  // then with points on the boundary
  }};
  for (const auto& [turn, how] : ways) {
    Attempt attempt{{}, UnitFrame(skin.mesh.X, turn)};
    // Bounded by -a, volumes come out at about two thirds of the bound: hence 1.5 times the volume
    // of the regular tetrahedron.
    const double volume = 1.5 * std::pow(attempt.frame.length_in(edge), 3) / (6.0 * std::sqrt(2.0));
    tetgenio in;
    hand_over(skin, attempt.frame, in);
    in.numberofholes = static_cast<int>(holes.size());
    in.holelist = new REAL[3 * holes.size()];
    for (size_t i = 0; i < holes.size(); ++i)
      Eigen::Map<Vector3d>(in.holelist + 3 * i) = attempt.frame.in(holes[i]);
    const std::string switches =
        fmt::format("{}q{:.3f}/{:.3f}a{:.17g}Q", how, options.radius_edge_ratio,
                    options.min_dihedral_deg, volume);
    if (run_tetgen(switches, in, attempt.out)) return attempt;
  }
  return {{}, UnitFrame(skin.mesh.X, unturned)};
}

/// Beyond that a factorization takes tens of GB.
constexpr double kMostTetrahedra = 1e6;

void refuse_too_fine(const SurfaceMesh& surface, double edge, const Place& place) {
  const double count = detail::six_volume(surface) / (edge * edge * edge / std::sqrt(2.0));
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
  const auto [out, frame] = filled(skin, detail::cavities(surface), options, edge);
  if (out.corners.empty()) refuse(surface, "TetGen gave up", place);

  TetMesh mesh = taken_back(out, frame, skin.mesh);
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
