#include "estimation/model/boundary_faces.h"

#include "simulation/quadrature.h"

namespace hookeye {

BoundaryFaces::BoundaryFaces(const TetMesh& mesh)
    : mesh_(mesh), opposite_(static_cast<size_t>(mesh.size()), {false, false, false, false}) {
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    const int element = mesh.boundary_element[static_cast<size_t>(f)];
    for (int c = 0; c < 4; ++c) {
      const auto corners = mesh.boundary.col(f).head<3>();
      if ((corners.array() != mesh.elements(c, element)).all())
        opposite_[static_cast<size_t>(element)][static_cast<size_t>(c)] = true;
    }
  }
}

int BoundaryFaces::opposite(const SurfacePoint& point) const {
  const auto& of = opposite_[static_cast<size_t>(point.element)];
  int out = -1;
  for (int c = 0; c < 4; ++c)
    if (of[static_cast<size_t>(c)] && (out < 0 || point.barycentric[c] < point.barycentric[out]))
      out = c;
  return std::max(out, 0);
}

Vector3d BoundaryFaces::normal(const SurfacePoint& point) const {
  const int corner = opposite(point);
  const Eigen::Matrix3d back = rest_gradient(mesh_, point).inverse();  // rows: gradients of 1..3
  const Vector3d inward = corner == 0 ? Vector3d(-back.colwise().sum().transpose())
                                      : Vector3d(back.row(corner - 1).transpose());
  return -inward.normalized();
}

/// Positions of an element's nodes: 3 x (4 or 10).
Matrix3Xd nodes_of(const TetMesh& mesh, int element, const VectorXd* q) {
  Matrix3Xd out(3, mesh.elements.rows());
  for (Eigen::Index a = 0; a < out.cols(); ++a) {
    const int node = mesh.elements(a, element);
    out.col(a) = q ? Vector3d(q->segment<3>(3 * node)) : Vector3d(mesh.X.col(node));
  }
  return out;
}

/// dX/d(barycentric 1..3) at rest.
Eigen::Matrix3d rest_gradient(const TetMesh& mesh, const SurfacePoint& point) {
  return nodes_of(mesh, point.element) * shape_derivatives(mesh.order, point.barycentric);
}

}  // namespace hookeye
