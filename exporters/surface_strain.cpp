#include "exporters/surface_strain.h"

#include <cmath>

#include "simulation/quadrature.h"

namespace hookeye {

namespace {

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
  return (nodes_of(mesh, point.element, &q) - nodes_of(mesh, point.element)) *
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
