// The surface of a body at a point: its face, its normal, and gradients there.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "meshing/tet_mesh.h"

namespace hookeye {

using Tangents = Eigen::Matrix<double, 3, 2>;  ///< two unit vectors in the surface at rest

/// Which faces of the elements are the boundary's.
class BoundaryFaces {
 public:
  explicit BoundaryFaces(const TetMesh& mesh);
  /// Of the boundary faces of its element the one that the point lies on: the corner opposite.
  int opposite(const SurfacePoint& point) const;
  /// Outward normal there, unit.
  Vector3d normal(const SurfacePoint& point) const;

 private:
  const TetMesh& mesh_;
  std::vector<std::array<bool, 4>> opposite_;  ///< by element and corner
};
/// Positions of an element's nodes, at rest or in the state q (3n): 3 x (4 or 10).
Matrix3Xd nodes_of(const TetMesh& mesh, int element, const VectorXd* q = nullptr);
/// dX/d(barycentric 1..3) at rest.
Eigen::Matrix3d rest_gradient(const TetMesh& mesh, const SurfacePoint& point);

}  // namespace hookeye
