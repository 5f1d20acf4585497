// Surfaces that TetGen fills, in a helper of its own (helpers/tetgen.cpp).
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/helper.h"
#include "meshing/detail.h"

namespace hookeye::detail {

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

/// What is used of TetGen's output.
struct Filled {
  std::vector<double> points;           ///< 3 each
  std::vector<int> corners;             ///< 4 a tetrahedron
  std::vector<int> triangles, markers;  ///< 3 and 1 a face
};

std::vector<double> seen_from(const UnitFrame& frame, const Matrix3Xd& X) {
  std::vector<double> out(static_cast<size_t>(X.size()));
  for (Eigen::Index i = 0; i < X.cols(); ++i)
    Eigen::Map<Vector3d>(out.data() + 3 * i) = frame.in(X.col(i));
  return out;
}

/// Throws WireFault where an index goes beyond what it counts in.
Filled unpack_filled(Unpacker& from, size_t triangles_of_skin) {
  Filled out;
  from.get(out.points);
  from.get(out.corners);
  from.get(out.triangles);
  from.get(out.markers);
  const auto points = static_cast<int>(out.points.size() / 3);
  const auto in_points = [&](int i) { return i >= 0 && i < points; };
  if (out.points.size() % 3 != 0 || out.corners.size() % 4 != 0 ||
      out.triangles.size() != 3 * out.markers.size() ||
      !std::all_of(out.corners.begin(), out.corners.end(), in_points) ||
      !std::all_of(out.triangles.begin(), out.triangles.end(), in_points) ||
      std::any_of(out.markers.begin(), out.markers.end(),
                  [&](int m) { return m > static_cast<int>(triangles_of_skin); }))
    throw WireFault();
  return out;
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
  Matrix3Xd holes(3, static_cast<Eigen::Index>(task.holes.size()));
  for (size_t i = 0; i < task.holes.size(); ++i)
    holes.col(static_cast<Eigen::Index>(i)) = task.holes[i];
  const std::string switches = fmt::format(
      "p{}q{:.3f}/{:.3f}a{:.17g}S{:.0f}Q", task.keep_surface ? "Y" : "", task.radius_edge_ratio,
      task.min_dihedral_deg, task.volume * std::pow(frame.length_in(1.0), 3), task.most_points);
  HelperRequest request;
  request.name = "tetgen";
  request.content = Packer()
                        .put(switches)
                        .put(seen_from(frame, skin.X))
                        .put(skin.triangles)
                        .put(seen_from(frame, holes))
                        .take();
  request.limits = {unlimited.memory, task.seconds};
  request.once = true;  // its predicates remember the last body
  request.interruptible = true;
  TetGenAnswer answer;
  Filled out;
  bool well = false;
  try {
    ask_helper(request, [&](Unpacker& from) {
      well = from.take<bool>();
      answer.seconds = from.take<double>();
      if (well) out = unpack_filled(from, skin.triangles.size());
      return well;
    });
  } catch (const HelperDied& died) {
    answer.in_time = died.within_limits();
    answer.seconds = died.seconds();
  }
  if (!well) return answer;
  TetMesh mesh = taken_back(out, frame, skin);
  if (!name_boundary(mesh, out)) return answer;
  drop_unused(mesh);
  find_boundary(mesh);
  answer.mesh = std::move(mesh);
  return answer;
}

}  // namespace hookeye::detail
