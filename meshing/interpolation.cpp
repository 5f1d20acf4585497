#include "meshing/interpolation.h"

#include <Eigen/LU>
#include <algorithm>

namespace hookeye {

namespace {

/// Barycentric coordinates of all straight tetrahedra as one map: coordinate c of element e at X is
/// row 4 e + c times (X, 1).
Eigen::MatrixXd barycentric_maps(const TetMesh& mesh) {
  const int elements = static_cast<int>(mesh.elements.cols());
  Eigen::MatrixXd maps(4 * elements, 4);
  for (int e = 0; e < elements; ++e) {
    Eigen::Matrix4d corners = Eigen::Matrix4d::Ones();
    for (int c = 0; c < 4; ++c) corners.block<3, 1>(0, c) = mesh.X.col(mesh.elements(c, e));
    maps.middleRows<4>(4 * e) = corners.inverse();
  }
  return maps;
}

}  // namespace

Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation(const TetMesh& mesh,
                                                           const Matrix3Xd& X) {
  const Eigen::MatrixXd maps = barycentric_maps(mesh);
  const int count = static_cast<int>(X.cols());
  constexpr int kBlock = 8;  // all elements times so many points at once: they stay in the cache
  std::vector<Eigen::Triplet<double>> entries;
  for (int first = 0; first < count; first += kBlock) {
    const int n = std::min(kBlock, count - first);
    const Eigen::MatrixXd all = maps * X.middleCols(first, n).colwise().homogeneous();
    for (int i = 0; i < n; ++i) {
      const Eigen::Map<const Eigen::Matrix4Xd> barycentric(all.col(i).data(), 4, maps.rows() / 4);
      Eigen::Index element;
      barycentric.colwise().minCoeff().maxCoeff(&element);
      const VectorXd N = shape_functions(mesh.order, barycentric.col(element));
      for (int a = 0; a < N.size(); ++a)
        entries.emplace_back(first + i, mesh.elements(a, element), N[a]);
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> W(count, mesh.X.cols());
  W.setFromTriplets(entries.begin(), entries.end());
  return W;
}

}  // namespace hookeye
