#include "render/vertex_normals.h"

#include <algorithm>
#include <cmath>

namespace hookeye {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

Matrix3Xd of_unit_length(Matrix3Xd n) {
  for (Eigen::Index v = 0; v < n.cols(); ++v) {
    const double length = n.col(v).norm();
    if (length > 0) n.col(v) /= length;
  }
  return n;
}

/// d(N/|N|)/dN.
Matrix3d projection(const Vector3d& N) {
  const double length = N.norm();
  if (!(length > 0)) return Matrix3d::Zero();
  return (Matrix3d::Identity() - N * N.transpose() / (length * length)) / length;
}

}  // namespace

VertexNormals::VertexNormals(const SurfaceMesh& surface)
    : triangles_(surface.cut_from.empty() ? surface.triangles : surface.cut_from),
      vertices_(static_cast<int>(surface.cut_from.empty() ? surface.X.cols()
                                                          : surface.cut_weights.cols())),
      weights_(surface.cut_weights) {
  std::vector<std::vector<int>> around(vertices_);
  for (int v = 0; v < vertices_; ++v) around[v].push_back(v);
  for (const auto& t : triangles_)
    for (int i : t)
      for (int j : t)
        if (i != j) around[i].push_back(j);
  first_.push_back(0);
  for (auto& list : around) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    neighbour_.insert(neighbour_.end(), list.begin(), list.end());
    first_.push_back(static_cast<int>(neighbour_.size()));
  }
  for (const auto& t : triangles_) {
    auto& p = position_.emplace_back();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        p[3 * i + j] =
            static_cast<int>(std::lower_bound(neighbour_.begin() + first_[t[i]],
                                              neighbour_.begin() + first_[t[i] + 1], t[j]) -
                             neighbour_.begin());
  }
}

Matrix3Xd VertexNormals::sums(const Matrix3Xd& x) const {
  Matrix3Xd n = Matrix3Xd::Zero(3, vertices_);
  for (const auto& t : triangles_) {
    const Vector3d c = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0]));
    const double area2 = c.norm();
    if (area2 <= 0) continue;
    for (int i = 0; i < 3; ++i) {
      const Vector3d e1 = x.col(t[(i + 1) % 3]) - x.col(t[i]);
      const Vector3d e2 = x.col(t[(i + 2) % 3]) - x.col(t[i]);
      n.col(t[i]) += std::atan2(area2, e1.dot(e2)) / area2 * c;
    }
  }
  return n;
}

Matrix3Xd VertexNormals::own(const Matrix3Xd& x) const { return of_unit_length(sums(x)); }

Matrix3Xd VertexNormals::at(const Matrix3Xd& x) const {
  if (weights_.size() == 0) return own(x);
  return of_unit_length((weights_ * own(x).transpose()).transpose());
}

Eigen::SparseMatrix<double, Eigen::RowMajor> VertexNormals::derivative(const Matrix3Xd& x) const {
  if (weights_.size() == 0) return own_derivative(x);
  const Matrix3Xd mean = (weights_ * own(x).transpose()).transpose();
  Eigen::SparseMatrix<double, Eigen::RowMajor> by_cut(3 * weights_.rows(), 3 * weights_.cols());
  by_cut.reserve(9 * weights_.nonZeros());  // d(n)/d(n of the cut triangles' vertices)
  for (int v = 0; v < weights_.outerSize(); ++v) {
    const Matrix3d project = projection(mean.col(v));
    for (int r = 0; r < 3; ++r) {
      by_cut.startVec(3 * v + r);
      for (decltype(weights_)::InnerIterator w(weights_, v); w; ++w)
        for (int c = 0; c < 3; ++c)
          by_cut.insertBack(3 * v + r, 3 * static_cast<int>(w.col()) + c) =
              w.value() * project(r, c);
    }
  }
  by_cut.finalize();
  return by_cut * own_derivative(x);
}

Eigen::SparseMatrix<double, Eigen::RowMajor> VertexNormals::own_derivative(
    const Matrix3Xd& x) const {
  // Blocks d(N_v)/d(x_u), then the projection of the normalisation.
  std::vector<Matrix3d> block(neighbour_.size(), Matrix3d::Zero());
  for (size_t f = 0; f < triangles_.size(); ++f) {
    const auto& t = triangles_[f];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const Vector3d e1 = x.col(t[j]) - x.col(t[i]), e2 = x.col(t[k]) - x.col(t[i]);
      const Vector3d c = e1.cross(e2);
      const double s = c.norm(), d = e1.dot(e2);
      if (s <= 0) continue;
      const Vector3d n = c / s;
      const double angle = std::atan2(s, d), scale = 1 / (s * s + d * d);
      // dc = de1 x e2 + e1 x de2
      const Matrix3d dc_de1 = -cross_matrix(e2), dc_de2 = cross_matrix(e1);
      const Matrix3d spin = angle / s * (Matrix3d::Identity() - n * n.transpose());
      const Matrix3d d1 =
          n * (scale * (d * n.transpose() * dc_de1 - s * e2.transpose())) + spin * dc_de1;
      const Matrix3d d2 =
          n * (scale * (d * n.transpose() * dc_de2 - s * e1.transpose())) + spin * dc_de2;
      block[position_[f][3 * i + j]] += d1;
      block[position_[f][3 * i + k]] += d2;
      block[position_[f][3 * i + i]] -= d1 + d2;
    }
  }
  const Matrix3Xd sum = sums(x);
  Eigen::SparseMatrix<double, Eigen::RowMajor> out(3 * vertices_, 3 * x.cols());
  out.resizeNonZeros(9 * static_cast<Eigen::Index>(neighbour_.size()));
  for (int v = 0; v < vertices_; ++v) {
    const int blocks = first_[v + 1] - first_[v];
    for (int r = 0; r < 3; ++r) out.outerIndexPtr()[3 * v + r] = 9 * first_[v] + 3 * r * blocks;
    const Matrix3d project = projection(sum.col(v));
    for (int b = 0; b < blocks; ++b) {
      const Matrix3d d = project * block[first_[v] + b];
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          const int at = 9 * first_[v] + 3 * r * blocks + 3 * b + c;
          out.innerIndexPtr()[at] = 3 * neighbour_[first_[v] + b] + c;
          out.valuePtr()[at] = d(r, c);
        }
    }
  }
  out.outerIndexPtr()[3 * vertices_] = 9 * static_cast<int>(neighbour_.size());
  return out;
}

}  // namespace hookeye
