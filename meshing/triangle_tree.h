// Nearest triangle and overlapping boxes: a bounding volume tree over triangles, in double.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "meshing/surface_mesh.h"

namespace hookeye::detail {

struct Hit {
  int triangle = -1;
  double distance = 0.0;
  Vector3d weights = Vector3d::Zero();  ///< barycentric in the triangle
};

/// Closest point of a triangle to p, as barycentric weights (Ericson, Real-Time Collision
/// Detection, 5.1.5).
Vector3d closest_weights(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                         const Vector3d& c);

class TriangleTree {
 public:
  TriangleTree(Matrix3Xd X, std::vector<std::array<int, 3>> triangles);
  /// Nearest point; ties go to the smallest triangle index.
  Hit nearest(const Vector3d& p) const;
  /// Triangles whose boxes touch `box`, ascending.
  std::vector<int> touching(const Eigen::AlignedBox3d& box) const;
  const Eigen::AlignedBox3d& box_of(int triangle) const { return boxes_[triangle]; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int left = -1, right = -1;  ///< children; -1: leaf
    int first = 0, last = 0;    ///< range of order_
  };
  int build(int first, int last);

  Matrix3Xd X_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace hookeye::detail
