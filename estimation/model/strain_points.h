// Measured strains on a body: the axes that they are along, and the gradients that make them.
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "capture_io/strain_field.h"
#include "estimation/model/boundary_faces.h"
#include "estimation/model/model.h"

namespace hookeye {

/// The points of a gauge's disc that a plane is laid through.
struct StrainWindow {
  std::vector<SurfacePoint> at;
  Eigen::Matrix2Xd offset;  ///< where they were sought, from the centre along the tangents [length]
  Eigen::Matrix2Xd weights;  ///< of what they have in the plane's gradient [1/length]
};

struct StrainPoints {
  /// Gradient in the surface at rest, along either tangent, of what nodes have: points x nodes.
  /// Over a gauge it is that of the plane which fits the points of its disc best.
  std::array<Eigen::SparseMatrix<double, Eigen::RowMajor>, 2> D;
  std::vector<Tangents> tangents;  ///< by point, orthonormal
  /// By point, where they were asked for; `at` is empty where the gradient is the point's own.
  std::vector<StrainWindow> windows;
};
/// Throws InputError with file and line where the axes of the strains do not lie in the surface.
StrainPoints strain_points(const TetMesh& mesh, const FieldSpec& field,
                           const BoundaryLocator& locator, bool windows = false);

/// The first axis laid into the surface, the second to the side of the other. Empty: one of them is
/// (nearly) normal to the surface.
std::optional<Tangents> tangents_along(const Vector3d& normal,
                                       const Eigen::Matrix<double, 3, 2>& axes);
/// Of all points of a field of strains; throws as above.
std::vector<Tangents> strain_tangents(const TetMesh& mesh, const FieldSpec& field,
                                      const BoundaryLocator& locator);

/// Strains at one point where nodes are at q, along the told axes as `placement` turns the body
/// below them; their derivatives by the nodes' columns S and by what turns the placement.
struct PointStrain {
  Vector3d e;
  Eigen::MatrixXd J;  ///< 3 x columns; empty: no derivative was asked for
};
/// Columns of the placement's derivative, nine numbers, that have any.
using Turning = std::vector<std::pair<Eigen::Index, Eigen::Matrix3d>>;

class PointStrainer {
 public:
  /// `mesh`: the one that `points` were found on.
  PointStrainer(const TetMesh& mesh, const FieldSpec& field, const StrainPoints& points,
                const Eigen::Matrix3d& placement);
  /// S: dq/dp, 3n x columns, null: no derivative; `turning`: of `placement`.
  PointStrain at(Eigen::Index point, const VectorXd& q, const Eigen::MatrixXd* S,
                 const Turning& turning) const;
  /// The same, where the derivative of A = F T is known, and that of the tangents T themselves: 6 x
  /// columns each, column of A after column.
  PointStrain at(Eigen::Index point, const VectorXd& q, const Eigen::MatrixXd& d_A,
                 const Eigen::MatrixXd& d_T, const Turning& turning) const;

 private:
  Tangents went(Eigen::Index point, const VectorXd& q) const;
  const TetMesh& mesh_;
  const StrainSpec& strain_;
  const StrainPoints& points_;
  Eigen::Matrix3d placement_;
};

}  // namespace hookeye
