// Strains of the surface, as image correlation tells them.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "estimation/model/boundary_faces.h"

namespace hookeye {

/// Green-Lagrange strain in the plane of the surface: E = 1/2 (T^T F^T F T - 1).
struct SurfaceStrain {
  double xx = 0, yy = 0, xy = 0;  ///< xy is the tensor's, half of the engineering shear
  double first() const;           ///< larger principal strain
  double second() const;
  double angle() const;  ///< of the first from x towards y, -90 to 90 [degrees]
  /// 2/sqrt(3) sqrt(e1^2 + e1 e2 + e2^2): of a strain whose third principal one is -(e1 + e2), as
  /// of a body that keeps its volume.
  double von_mises() const;
};
/// A = F T.
SurfaceStrain strain_of(const Tangents& A);
/// The same in other tangents of the same plane: `turn` = old tangents^T new ones.
SurfaceStrain turned(const SurfaceStrain& strain, const Eigen::Matrix2d& turn);

/// The first is `along` laid into the surface (where that is normal to it: another axis), the
/// second the normal crossed with it.
Tangents tangents_of(const Vector3d& normal, const Vector3d& along);

/// Deformed position less rest position, and F = dx/dX, of a material point in the state q (3n).
Vector3d displacement_at(const TetMesh& mesh, const VectorXd& q, const SurfacePoint& point);
Eigen::Matrix3d gradient_at(const TetMesh& mesh, const VectorXd& q, const SurfacePoint& point);

/// Gradient in the surface (3 x 2, by `tangents`) of what is told at points X (3 x n) about
/// `centre` as `values` (3 x n): least squares of a plane. Empty: the points lie on a line.
std::optional<Tangents> gradient_in_surface(const Eigen::Matrix3Xd& X,
                                            const Eigen::Matrix3Xd& values, const Vector3d& centre,
                                            const Tangents& tangents);

}  // namespace hookeye
