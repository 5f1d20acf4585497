#include "exporters/surface_strain.h"

#include <cmath>

#include "simulation/quadrature.h"

namespace hookeye {

namespace {

/// Positions of an element's nodes: 3 x (4 or 10).
Eigen::Matrix3Xd nodes_of(const TetMesh& mesh, int element, const VectorXd* q) {
  Eigen::Matrix3Xd out(3, mesh.elements.rows());
  for (Eigen::Index a = 0; a < out.cols(); ++a) {
    const int node = mesh.elements(a, element);
    out.col(a) = q ? Vector3d(q->segment<3>(3 * node)) : Vector3d(mesh.X.col(node));
  }
  return out;
}

/// dX/d(barycentric 1..3) at rest.
Eigen::Matrix3d rest_gradient(const TetMesh& mesh, const SurfacePoint& point) {
  return nodes_of(mesh, point.element, nullptr) * shape_derivatives(mesh.order, point.barycentric);
}

double half_difference(const SurfaceStrain& e) { return std::hypot(0.5 * (e.xx - e.yy), e.xy); }

}  // namespace

double SurfaceStrain::first() const { return 0.5 * (xx + yy) + half_difference(*this); }
double SurfaceStrain::second() const { return 0.5 * (xx + yy) - half_difference(*this); }

double SurfaceStrain::angle() const {
  return 0.5 * std::atan2(2.0 * xy, xx - yy) * 180.0 / EIGEN_PI;
}

double SurfaceStrain::von_mises() const {
  const double a = first(), b = second();
  return 2.0 / std::sqrt(3.0) * std::sqrt(a * a + a * b + b * b);
}

SurfaceStrain strain_of(const Tangents& A) {
  const Eigen::Matrix2d E = 0.5 * (A.transpose() * A - Eigen::Matrix2d::Identity());
  return {E(0, 0), E(1, 1), E(0, 1)};
}

SurfaceStrain turned(const SurfaceStrain& strain, const Eigen::Matrix2d& turn) {
  Eigen::Matrix2d E;
  E << strain.xx, strain.xy, strain.xy, strain.yy;
  const Eigen::Matrix2d out = turn.transpose() * E * turn;
  return {out(0, 0), out(1, 1), out(0, 1)};
}

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

Tangents tangents_of(const Vector3d& normal, const Vector3d& along) {
  constexpr double kNormal = 0.05;  // sine: nearer to the normal a direction in it is chance
  Vector3d x = along.normalized();
  for (int k = 0; k < 3 && x.cross(normal).norm() < kNormal; ++k) x = Vector3d::Unit(k);
  Tangents out;
  out.col(0) = (x - x.dot(normal) * normal).normalized();
  out.col(1) = normal.cross(Vector3d(out.col(0)));
  return out;
}

Vector3d displacement_at(const TetMesh& mesh, const VectorXd& q, const SurfacePoint& point) {
  return (nodes_of(mesh, point.element, &q) - nodes_of(mesh, point.element, nullptr)) *
         shape_functions(mesh.order, point.barycentric);
}

Eigen::Matrix3d gradient_at(const TetMesh& mesh, const VectorXd& q, const SurfacePoint& point) {
  return nodes_of(mesh, point.element, &q) * shape_derivatives(mesh.order, point.barycentric) *
         rest_gradient(mesh, point).inverse();
}

std::optional<Tangents> gradient_in_surface(const Eigen::Matrix3Xd& X,
                                            const Eigen::Matrix3Xd& values, const Vector3d& centre,
                                            const Tangents& tangents) {
  Eigen::MatrixX3d plane(X.cols(), 3);
  plane.col(0).setOnes();
  plane.rightCols<2>() = (X.colwise() - centre).transpose() * tangents;
  const Eigen::Matrix2d spread = plane.rightCols<2>().transpose() * plane.rightCols<2>() -
                                 plane.rightCols<2>().colwise().sum().transpose() *
                                     plane.rightCols<2>().colwise().sum() /
                                     static_cast<double>(X.cols());
  const Eigen::Vector2d widths =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues();
  if (X.cols() < 4 || !(widths[0] > 0.02 * widths[1])) return {};
  const Eigen::MatrixX3d fitted = plane.colPivHouseholderQr().solve(values.transpose());
  return Tangents(fitted.bottomRows<2>().transpose());
}

}  // namespace hookeye
