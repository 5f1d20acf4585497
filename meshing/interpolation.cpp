#include "meshing/interpolation.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

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

/// The tetrahedra whose boxes reach into each cell of a grid of about as many cells.
class ElementGrid {
 public:
  explicit ElementGrid(const TetMesh& mesh) {
    const Matrix3Xd X = mesh.X;
    low_ = X.rowwise().minCoeff();
    const Vector3d size = (X.rowwise().maxCoeff() - low_).cwiseMax(1e-300);
    const auto elements = mesh.elements.cols();
    cell_ = std::cbrt(size.prod() / static_cast<double>(std::max<Eigen::Index>(elements, 1)));
    cell_ = std::max(cell_, size.maxCoeff() / 1000.0);  // of a flat body
    for (int i = 0; i < 3; ++i) count_[i] = 1 + static_cast<int>(size[i] / cell_);
    inside_.resize(static_cast<size_t>(count_[0]) * count_[1] * count_[2]);
    for (int e = 0; e < elements; ++e) {
      Matrix3Xd corners(3, 4);
      for (int c = 0; c < 4; ++c) corners.col(c) = X.col(mesh.elements(c, e));
      const auto first = place(corners.rowwise().minCoeff());
      const auto last = place(corners.rowwise().maxCoeff());
      for (int z = first[2]; z <= last[2]; ++z)
        for (int y = first[1]; y <= last[1]; ++y)
          for (int x = first[0]; x <= last[0]; ++x) inside_[index({x, y, z})].push_back(e);
    }
  }
  const std::vector<int>& near(const Vector3d& X) const { return inside_[index(place(X))]; }

 private:
  using Place = std::array<int, 3>;
  Place place(const Vector3d& X) const {
    Place out;
    for (int i = 0; i < 3; ++i)
      out[i] = std::clamp(static_cast<int>((X[i] - low_[i]) / cell_), 0, count_[i] - 1);
    return out;
  }
  size_t index(const Place& at) const {
    return (static_cast<size_t>(at[2]) * count_[1] + at[1]) * count_[0] + at[0];
  }
  Vector3d low_;
  double cell_ = 1.0;
  Place count_;
  std::vector<std::vector<int>> inside_;
};

/// The tetrahedron that holds X, else the one that it leaves least of all.
class ElementFinder {
 public:
  explicit ElementFinder(const TetMesh& mesh) : maps_(barycentric_maps(mesh)), grid_(mesh) {}

  int find(const Vector3d& X, Eigen::Vector4d& barycentric) const {
    double most = -1.0;
    int found = -1;
    for (int e : grid_.near(X)) {
      const Eigen::Vector4d b = maps_.middleRows<4>(4 * e) * X.homogeneous();
      if (b.minCoeff() < 0.0 || b.minCoeff() <= most) continue;
      most = b.minCoeff(), found = e, barycentric = b;
    }
    return found >= 0 ? found : nearest(X, barycentric);
  }

 private:
  int nearest(const Vector3d& X, Eigen::Vector4d& barycentric) const {
    const VectorXd all = maps_ * X.homogeneous();
    const Eigen::Map<const Eigen::Matrix4Xd> by_element(all.data(), 4, maps_.rows() / 4);
    Eigen::Index element;
    by_element.colwise().minCoeff().maxCoeff(&element);
    barycentric = by_element.col(element);
    return static_cast<int>(element);
  }
  Eigen::MatrixXd maps_;
  ElementGrid grid_;
};

}  // namespace

Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation(const TetMesh& mesh,
                                                           const Matrix3Xd& X) {
  const ElementFinder finder(mesh);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < X.cols(); ++i) {
    Eigen::Vector4d barycentric;
    const int element = finder.find(X.col(i), barycentric);
    const VectorXd N = shape_functions(mesh.order, barycentric);
    for (int a = 0; a < N.size(); ++a) entries.emplace_back(i, mesh.elements(a, element), N[a]);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> W(X.cols(), mesh.X.cols());
  W.setFromTriplets(entries.begin(), entries.end());
  return W;
}

}  // namespace hookeye
