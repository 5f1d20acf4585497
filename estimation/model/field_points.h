// Measured fields on a body: where their points are on its mesh.
#pragma once

#include <Eigen/SparseCore>

#include "estimation/model/model.h"

namespace hookeye {

struct FieldPoints {
  /// Shape functions at the points, projected to the surface: points x nodes.
  Eigen::SparseMatrix<double, Eigen::RowMajor> N;
  Matrix3Xd rest;  ///< N applied to the mesh at rest
  VectorXd gap;    ///< distance of the told point from there [length]
};
FieldPoints field_points(const TetMesh& mesh, const FieldSpec& field);

/// How far a point may lie off the surface: what is told, or 2 % of the body's extent.
double field_tolerance(const TetMesh& mesh, const FieldSpec& field);

/// Throws InputError with file and line for the point that lies farthest off the surface, if that
/// is beyond the tolerance; hints at a wrong unit where that would bring the points onto it.
void check_fields(const Scene& scene, const ExampleSpec& example);

}  // namespace hookeye
