// Quadrature and shape functions of tetrahedra and triangles.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "meshing/tet_mesh.h"

namespace hookeye {

using Eigen::MatrixXd;

/// Points in barycentric coordinates; weights sum to 1.
struct TetRule {
  std::vector<Eigen::Vector4d> points;
  std::vector<double> weights;
};
/// One point for order 1; four points, exact to degree 2, for order 2 (CalculiX C3D4, C3D10).
const TetRule& stiffness_rule(int order);

/// dN/d(barycentric 1..3), (4 or 10) x 3, barycentric 0 eliminated.
MatrixXd shape_derivatives(int order, const Eigen::Vector4d& barycentric);
/// N (4 or 10).
VectorXd shape_values(int order, const Eigen::Vector4d& barycentric);

/// Six points, exact to degree 4 (Dunavant 1985), on a triangle of 3 or 6 nodes.
struct FacePoint {
  double weight;  ///< weights sum to 1/2, the area of the parameter triangle
  VectorXd N;
  Eigen::Matrix<double, Eigen::Dynamic, 2> dN;
};
const std::vector<FacePoint>& face_rule(int order);
/// The same on each quarter of the triangle, for what begins and ends within a face.
const std::vector<FacePoint>& fine_face_rule(int order);

}  // namespace hookeye
