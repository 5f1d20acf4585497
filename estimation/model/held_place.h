// Which material point lies at a fixed place of a body that moves with the parameters.
#pragma once

#include "estimation/model/boundary_faces.h"

namespace hookeye {

/// The foot of a place on the surface, as BoundaryLocator finds it: on the flat triangle between
/// the nodes of a face, of a quadratic one on one of four. Where the surface moves, the foot stays
/// and another material point lies there. With f = sum w_c x_c, edges e_i and the place x it is
/// told by e_i . (f - x) = 0; past a rim the foot keeps to the rim, and at its end to the corner.
class HeldPlace {
 public:
  /// `mesh`: with its nodes where the surface is.
  HeldPlace(const TetMesh& mesh, const BoundaryFaces& faces, const SurfacePoint& at,
            const Vector3d& place);
  /// d(barycentric 1..3) of the point, 3 x columns. S: of the nodes, 3n x columns; d_place: 3 x
  /// columns, null: it stands still.
  Eigen::MatrixXd moved(const Eigen::MatrixXd& S, const Eigen::MatrixXd* d_place) const;

 private:
  std::array<int, 3> nodes_;
  Eigen::Vector3d weights_;
  Eigen::Matrix<double, 3, 2> edges_;
  Vector3d gap_;                    ///< f - x
  Eigen::Matrix<double, 3, 2> by_;  ///< barycentric 1..3 by the weights of the last two nodes
  Eigen::Matrix2d answer_;          ///< the weights by what the edges' conditions are off
};

/// Positions and their gradients in one element: what a point there has, and how that goes with the
/// nodes and with the point.
struct ElementPoint {
  ElementPoint(const TetMesh& mesh, const SurfacePoint& at);
  /// What the nodes' columns S (3n x columns) make of the point itself, 3 x columns.
  Eigen::MatrixXd of(const Eigen::MatrixXd& S) const;
  /// The gradient by barycentric 1..3 of column `j` of S.
  Eigen::Matrix3d gradient(const Eigen::MatrixXd& S, Eigen::Index j) const;
  /// How the gradient of the places q goes where the point moves by `d`.
  Eigen::Matrix3d gradient_moved(const Matrix3Xd& nodes, const Vector3d& d) const;

  int order;
  Eigen::VectorXi nodes;
  Eigen::Vector4d barycentric;
  VectorXd N;
  Eigen::MatrixXd dN;  ///< by barycentric 1..3
};

}  // namespace hookeye
