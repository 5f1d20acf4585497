// Rigid motions of a mesh that supports leave free.
#pragma once

#include "simulation/loading.h"

namespace hookeye {

/// Rigid motions m = (v, w * size): unknown (a, i) moves by row(3 a + i) . m.
struct RigidModes {
  explicit RigidModes(const TetMesh& mesh);
  Eigen::Matrix<double, 6, 1> row(int unknown) const;
  /// Orthonormal basis, 6 x k, of the motions that move none of the prescribed unknowns.
  Eigen::MatrixXd free(const std::vector<int>& prescribed) const;
  /// k unknowns that, held too, stop the free motions; ascending.
  std::vector<int> pins(Eigen::MatrixXd free) const;
  /// Work of nodal forces (3n) on the free motions relative to the forces' size: 0 where balanced.
  double imbalance(const Eigen::MatrixXd& free, const VectorXd& force) const;

  const TetMesh& mesh;
  Vector3d center;
  double size;
};

}  // namespace hookeye
