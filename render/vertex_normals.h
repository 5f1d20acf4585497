// Vertex normals and their linearisation. Internal to render.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

namespace hookeye {

/// n_v = N_v/|N_v|, N_v = sum over the corners at v of (corner angle) times (unit face normal).
/// The sums by area differ visibly where triangles are uneven; renderers use the angle.
class VertexNormals {
 public:
  VertexNormals(const std::vector<std::array<int, 3>>& triangles, int vertices);
  Eigen::Matrix3Xd at(const Eigen::Matrix3Xd& x) const;
  /// dn (3nv) = N dx (3nv); the pattern is built once.
  Eigen::SparseMatrix<double, Eigen::RowMajor> derivative(const Eigen::Matrix3Xd& x) const;

 private:
  Eigen::Matrix3Xd sums(const Eigen::Matrix3Xd& x) const;
  std::vector<std::array<int, 3>> triangles_;
  int vertices_;
  std::vector<int> first_, neighbour_;        ///< block rows: vertex -> itself and its neighbours
  std::vector<std::array<int, 9>> position_;  ///< triangle: block of (corner i, corner j)
};

}  // namespace hookeye
