// Fields from one mesh of a body to another.
#pragma once

#include <Eigen/SparseCore>

#include "meshing/tet_mesh.h"

namespace hookeye {

/// Values at rest positions X (3 x count) from nodal values: count x n, rows sum to 1. Every point
/// takes the shape functions of the tetrahedron (edges taken as straight) that holds it or, outside
/// the mesh, that it leaves least: there they extrapolate.
Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation(const TetMesh& mesh, const Matrix3Xd& X);

}  // namespace hookeye
