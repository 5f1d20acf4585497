#include "meshing/tet_mesh.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "meshing/detail.h"
#include "meshing/flat_tetrahedra.h"

namespace hookeye {
namespace detail {

double diagonal(const Matrix3Xd& X) {
  if (X.cols() == 0) return 0.0;
  return (X.rowwise().maxCoeff() - X.rowwise().minCoeff()).norm();
}

std::string where(const Vector3d& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z());
}

double jacobian(const TetMesh& mesh, int element, const Eigen::Vector4d& L) {
  const auto e = mesh.elements.col(element);
  Eigen::Matrix<double, 3, 4> by_L = Eigen::Matrix<double, 3, 4>::Zero();  // dx/dL
  if (mesh.order == 1) {
    for (int i = 0; i < 4; ++i) by_L.col(i) = mesh.X.col(e[i]);
  } else {
    for (int i = 0; i < 4; ++i) by_L.col(i) = (4.0 * L[i] - 1.0) * mesh.X.col(e[i]);
    for (int k = 0; k < 6; ++k) {
      const auto [i, j] = std::tie(kEdges[k][0], kEdges[k][1]);
      by_L.col(i) += 4.0 * L[j] * mesh.X.col(e[4 + k]);
      by_L.col(j) += 4.0 * L[i] * mesh.X.col(e[4 + k]);
    }
  }
  Eigen::Matrix3d J;
  for (int i = 0; i < 3; ++i) J.col(i) = by_L.col(i + 1) - by_L.col(0);
  return J.determinant();
}

}  // namespace detail

using detail::kEdges;
using detail::kFaces;

void find_boundary(TetMesh& mesh) {
  struct Face {
    std::array<int, 3> corners;
    int element, side;
  };
  std::vector<Face> faces;
  faces.reserve(4 * static_cast<size_t>(mesh.size()));
  for (int e = 0; e < mesh.size(); ++e) {
    for (int s = 0; s < 4; ++s) {
      std::array<int, 3> c{mesh.elements(kFaces[s][0], e), mesh.elements(kFaces[s][1], e),
                           mesh.elements(kFaces[s][2], e)};
      std::sort(c.begin(), c.end());
      faces.push_back({c, e, s});
    }
  }
  std::sort(faces.begin(), faces.end(),
            [](const Face& a, const Face& b) { return a.corners < b.corners; });
  std::vector<std::pair<int, int>> outer;
  for (size_t i = 0; i < faces.size();) {
    size_t j = i + 1;
    while (j < faces.size() && faces[j].corners == faces[i].corners) ++j;
    if (j == i + 1) outer.emplace_back(faces[i].element, faces[i].side);
    i = j;
  }
  std::sort(outer.begin(), outer.end());
  const int per_face = mesh.order == 1 ? 3 : 6;
  mesh.boundary.resize(per_face, static_cast<Eigen::Index>(outer.size()));
  mesh.boundary_element.resize(outer.size());
  for (size_t f = 0; f < outer.size(); ++f) {
    const auto [e, s] = outer[f];
    mesh.boundary_element[f] = e;
    for (int k = 0; k < per_face; ++k) {
      mesh.boundary(k, static_cast<Eigen::Index>(f)) = mesh.elements(kFaces[s][k], e);
    }
  }
}

namespace {

TetMesh raised(const TetMesh& mesh) {
  TetMesh out = mesh;
  out.order = 2;
  out.elements.resize(10, mesh.size());
  out.elements.topRows(4) = mesh.elements;
  std::map<std::pair<int, int>, int> mid_of;
  std::vector<Vector3d> mids;
  for (int e = 0; e < mesh.size(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const int a = mesh.elements(kEdges[k][0], e), b = mesh.elements(kEdges[k][1], e);
      const auto [it, fresh] =
          mid_of.try_emplace(std::minmax(a, b), mesh.nodes() + static_cast<int>(mids.size()));
      if (fresh) mids.push_back(0.5 * (mesh.X.col(a) + mesh.X.col(b)));
      out.elements(4 + k, e) = it->second;
    }
  }
  out.X.conservativeResize(3, mesh.nodes() + static_cast<Eigen::Index>(mids.size()));
  for (size_t i = 0; i < mids.size(); ++i) {
    out.X.col(mesh.nodes() + static_cast<Eigen::Index>(i)) = mids[i];
  }
  return out;
}

TetMesh lowered(const TetMesh& mesh) {
  TetMesh out = mesh;
  out.order = 1;
  out.elements = mesh.elements.topRows(4);
  std::vector<int> fresh(mesh.nodes(), -1);
  for (int e = 0; e < mesh.size(); ++e) {
    for (int k = 0; k < 4; ++k) fresh[out.elements(k, e)] = 0;
  }
  int n = 0;
  for (int i = 0; i < mesh.nodes(); ++i) {
    if (fresh[i] < 0) continue;
    out.X.col(n) = mesh.X.col(i);
    fresh[i] = n++;
  }
  out.X.conservativeResize(3, n);
  for (int e = 0; e < mesh.size(); ++e) {
    for (int k = 0; k < 4; ++k) out.elements(k, e) = fresh[out.elements(k, e)];
  }
  return out;
}

}  // namespace

TetMesh with_order(const TetMesh& mesh, int order) {
  if (order == mesh.order) return mesh;
  TetMesh out = order == 2 ? raised(mesh) : lowered(mesh);
  find_boundary(out);  // same elements in the same order: columns keep their meaning
  return out;
}

VectorXd shape_functions(int order, const Eigen::Vector4d& L) {
  if (order == 1) return L;
  VectorXd N(10);
  for (int i = 0; i < 4; ++i) N[i] = L[i] * (2.0 * L[i] - 1.0);
  for (int k = 0; k < 6; ++k) N[4 + k] = 4.0 * L[kEdges[k][0]] * L[kEdges[k][1]];
  return N;
}

namespace {

/// Integral of the Jacobian by the five-point rule of degree 3 (Keast 1986, rule 2): exact, for
/// the determinant of a quadratic tetrahedron is cubic.
double element_volume(const TetMesh& mesh, int e) {
  Eigen::Vector4d L = Eigen::Vector4d::Constant(0.25);
  if (mesh.order == 1) return detail::jacobian(mesh, e, L) / 6.0;
  double sum = -0.8 * detail::jacobian(mesh, e, L);
  for (int i = 0; i < 4; ++i) {
    L.setConstant(1.0 / 6.0);
    L[i] = 0.5;
    sum += 0.45 * detail::jacobian(mesh, e, L);
  }
  return sum / 6.0;
}

/// 3 inradius / circumradius of the corner tetrahedron.
double radius_ratio(const Eigen::Matrix<double, 3, 4>& x) {
  const Vector3d a = x.col(1) - x.col(0), b = x.col(2) - x.col(0), c = x.col(3) - x.col(0);
  const double six_volume = a.dot(b.cross(c));
  const double area = 0.5 * (a.cross(b).norm() + b.cross(c).norm() + c.cross(a).norm() +
                             (b - a).cross(c - a).norm());
  const Vector3d to_center =
      a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
  const double inradius = 0.5 * six_volume / area;
  const double circumradius = 0.5 * to_center.norm() / std::abs(six_volume);
  return 3.0 * inradius / circumradius;
}

std::pair<double, double> dihedral_range_deg(const Eigen::Matrix<double, 3, 4>& x) {
  std::array<Vector3d, 4> normal;
  for (int s = 0; s < 4; ++s) {
    const Vector3d p = x.col(kFaces[s][0]);
    normal[s] = (x.col(kFaces[s][1]) - p).cross(x.col(kFaces[s][2]) - p).normalized();
  }
  double low = 180.0, high = 0.0;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      const double cosine = std::clamp(-normal[i].dot(normal[j]), -1.0, 1.0);
      const double angle = std::acos(cosine) * 180.0 / std::numbers::pi;
      low = std::min(low, angle);
      high = std::max(high, angle);
    }
  }
  return {low, high};
}

}  // namespace

FlatTetrahedra flat_tetrahedra(const TetMesh& mesh, double ratio, double degrees) {
  FlatTetrahedra out;
  double least = 0.0;
  for (int e = 0; e < mesh.size(); ++e) {
    Eigen::Matrix<double, 3, 4> x;
    for (int k = 0; k < 4; ++k) x.col(k) = mesh.X.col(mesh.elements(k, e));
    const double its = radius_ratio(x);
    if (its >= ratio && dihedral_range_deg(x).first >= degrees) continue;
    if (out.count++ == 0 || its < least) least = its, out.where = x.rowwise().mean();
  }
  return out;
}

MeshQuality quality(const TetMesh& mesh) {
  MeshQuality q;
  q.nodes = mesh.nodes();
  q.elements = mesh.size();
  q.min_dihedral_deg = 180.0;
  q.min_radius_ratio = 1.0;
  double edges = 0.0;
  for (int e = 0; e < mesh.size(); ++e) {
    Eigen::Matrix<double, 3, 4> x;
    for (int k = 0; k < 4; ++k) x.col(k) = mesh.X.col(mesh.elements(k, e));
    q.volume += element_volume(mesh, e);
    for (const auto& [i, j] : kEdges) edges += (x.col(i) - x.col(j)).norm();
    const auto [low, high] = dihedral_range_deg(x);
    q.min_dihedral_deg = std::min(q.min_dihedral_deg, low);
    q.max_dihedral_deg = std::max(q.max_dihedral_deg, high);
    const double ratio = radius_ratio(x);
    if (q.worst_element < 0 || ratio < q.min_radius_ratio) {
      q.min_radius_ratio = ratio;
      q.worst_element = e;
    }
  }
  if (mesh.size() > 0) q.mean_edge = edges / (6.0 * mesh.size());
  return q;
}

}  // namespace hookeye
