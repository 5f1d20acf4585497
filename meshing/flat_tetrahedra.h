// Tetrahedra that are nearly flat, for messages: how many, and where.
#pragma once

#include "meshing/tet_mesh.h"

namespace hookeye {

struct FlatTetrahedra {
  int count = 0;
  Vector3d where = Vector3d::Zero();  ///< centre of the one of the least ratio, at rest [length]
};

/// Those whose radius ratio (MeshQuality::min_radius_ratio) is below `ratio`, or that have a
/// dihedral angle below `degrees`.
FlatTetrahedra flat_tetrahedra(const TetMesh& mesh, double ratio, double degrees);

}  // namespace hookeye
