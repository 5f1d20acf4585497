// Measured fields on a body: where their points are on its mesh.
#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "estimation/model/model.h"
#include "estimation/model/strain_points.h"

namespace hookeye {

struct FieldPoints {
  /// Shape functions at the points, projected to the surface: points x nodes.
  Eigen::SparseMatrix<double, Eigen::RowMajor> N;
  Matrix3Xd rest;                              ///< N applied to the mesh at rest
  VectorXd gap;                                ///< distance of the told point from there [length]
  std::vector<SurfacePoint> at;                ///< the same points by their elements
  std::shared_ptr<const StrainPoints> strain;  ///< of a field of strains
};
/// `windows`: of strains, StrainPoints::windows too.
FieldPoints field_points(const TetMesh& mesh, const FieldSpec& field, bool windows = false);

/// The example that a field starts from, by its number; -1: the body as it was given.
int start_index(const Scene& scene, const MeasuredSpec& measured);
/// The mesh as if it were at rest where its nodes are at q (3n): what points of a field that starts
/// from a load case lie on.
TetMesh mesh_at(const TetMesh& mesh, const VectorXd& q);

/// How far a point may lie off the surface: what is told, or 2 % of the body's extent.
double field_tolerance(const TetMesh& mesh, const FieldSpec& field);

/// Throws InputError with file and line for the point that lies farthest off the surface, if that
/// is beyond the tolerance; hints at a wrong unit where that would bring the points onto it. So do
/// axes of strains that do not lie in the surface. Of a field that starts from a load case, which
/// may have moved the body as far as it is long, it is told where points are beyond that too.
void check_fields(const Scene& scene, const ExampleSpec& example);

}  // namespace hookeye
