// Vertex normals and their linearisation.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "meshing/surface_mesh.h"

namespace hookeye {

/// n_v = N_v/|N_v|, N_v = sum over the corners at v of (corner angle) times (unit face normal).
/// The sums by area differ visibly where triangles are uneven; renderers use the angle. Of a
/// subdivided surface (SurfaceMesh::cut_from) those of the triangles that were cut, interpolated
/// and again of unit length.
class VertexNormals {
 public:
  explicit VertexNormals(const SurfaceMesh& surface);
  Eigen::Matrix3Xd at(const Eigen::Matrix3Xd& x) const;
  /// dn (3nv) = N dx (3nv); the pattern is built once.
  Eigen::SparseMatrix<double, Eigen::RowMajor> derivative(const Eigen::Matrix3Xd& x) const;

 private:
  Eigen::Matrix3Xd own(const Eigen::Matrix3Xd& x) const;
  Eigen::SparseMatrix<double, Eigen::RowMajor> own_derivative(const Eigen::Matrix3Xd& x) const;
  Eigen::Matrix3Xd sums(const Eigen::Matrix3Xd& x) const;
  std::vector<std::array<int, 3>> triangles_;
  int vertices_;                                          ///< that the triangles have
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights_;  ///< SurfaceMesh::cut_weights
  std::vector<int> first_, neighbour_;        ///< block rows: vertex -> itself and its neighbours
  std::vector<std::array<int, 9>> position_;  ///< triangle: block of (corner i, corner j)
};

}  // namespace hookeye
