// The only file that touches TetGen.
#include <fmt/format.h>
#include <sys/resource.h>
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

namespace hookeye::detail {

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

void hand_over(const SurfaceMesh& skin, const UnitFrame& frame, tetgenio& in) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(skin.X.cols());
  in.pointlist = new REAL[3 * skin.X.cols()];
  for (Eigen::Index i = 0; i < skin.X.cols(); ++i)
    Eigen::Map<Vector3d>(in.pointlist + 3 * i) = frame.in(skin.X.col(i));
  in.numberoffacets = static_cast<int>(skin.triangles.size());
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
    for (int k = 0; k < 3; ++k) f.polygonlist[0].vertexlist[k] = skin.triangles[t][k];
    in.facetmarkerlist[t] = t + 1;  // 0 would mean "none"
  }
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
[[noreturn]] void child(int pipe, std::string switches, tetgenio& in, double seconds) {
  die_quietly();
  const auto whole = static_cast<rlim_t>(std::max(1.0, std::ceil(seconds)));
  const rlimit time{whole, whole + 1};
  setrlimit(RLIMIT_CPU, &time);
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
/// frees it again while the exception passes, which ends the process. Not well: it gave up, or had
/// not ended after so many seconds of the processor.
Ended run_tetgen(const std::string& switches, tetgenio& in, double seconds, Filled& out) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t process = fork();
  if (process == 0) {
    close(ends[0]);
    child(ends[1], switches, in, seconds);
  }
  close(ends[1]);
  const bool whole = process > 0 && receive(ends[0], out.points) && receive(ends[0], out.corners) &&
                     receive(ends[0], out.triangles) && receive(ends[0], out.markers);
  close(ends[0]);
  Ended ended = await(process);
  ended.well = ended.well && whole;
  return ended;
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

/// Tells each face of the boundary the triangle of the skin on which it lies. False: one has none.
bool name_boundary(TetMesh& mesh, const Filled& out) {
  std::map<std::array<int, 3>, int> marker_of;
  for (size_t f = 0; f < out.markers.size(); ++f) {
    std::array<int, 3> c{out.triangles[3 * f], out.triangles[3 * f + 1], out.triangles[3 * f + 2]};
    std::sort(c.begin(), c.end());
    marker_of[c] = out.markers[f];
  }
  find_boundary(mesh);
  mesh.boundary_parent.clear();
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    std::array<int, 3> c{mesh.boundary(0, f), mesh.boundary(1, f), mesh.boundary(2, f)};
    std::sort(c.begin(), c.end());
    const auto it = marker_of.find(c);
    if (it == marker_of.end() || it->second < 1) return false;
    mesh.boundary_parent.push_back(it->second - 1);
  }
  return true;
}

}  // namespace

TetGenAnswer tetrahedra(const SurfaceMesh& skin, const TetGenTask& task) {
  const UnitFrame frame(skin.X, task.turn);
  tetgenio in;
  hand_over(skin, frame, in);
  in.numberofholes = static_cast<int>(task.holes.size());
  in.holelist = new REAL[3 * task.holes.size()];
  for (size_t i = 0; i < task.holes.size(); ++i)
    Eigen::Map<Vector3d>(in.holelist + 3 * i) = frame.in(task.holes[i]);
  const std::string switches = fmt::format(
      "p{}q{:.3f}/{:.3f}a{:.17g}S{:.0f}Q", task.keep_surface ? "Y" : "", task.radius_edge_ratio,
      task.min_dihedral_deg, task.volume * std::pow(frame.length_in(1.0), 3), task.most_points);
  Filled out;
  const Ended ended = run_tetgen(switches, in, task.seconds, out);
  TetGenAnswer answer{{}, ended.seconds, ended.in_time};
  if (!ended.well) return answer;
  TetMesh mesh = taken_back(out, frame, skin);
  if (!name_boundary(mesh, out)) return answer;
  drop_unused(mesh);
  find_boundary(mesh);
  answer.mesh = std::move(mesh);
  return answer;
}

}  // namespace hookeye::detail
