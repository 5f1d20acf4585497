// Rigid floor by a smoothed penalty on boundary nodes.
#include <Eigen/Dense>

#include "simulation/loading.h"
#include "simulation/quadrature.h"

namespace hookeye {
namespace {

/// Potential sum_a A_a k phi(d_a), depth d = -(x - point).n, with phi'(d) = 0 for d < 0, d^2/(2h)
/// up to the smoothing depth h, d - h/2 beyond. A_a: rest area of node a (integral of N_a), which
/// for quadratic faces lies on mid nodes only.
class FloorContact final : public ForceTerm {
 public:
  FloorContact(const TetMesh& mesh, const Vector3d& point, const Vector3d& normal, double k,
               double smoothing)
      : point_(point), n_(normal.normalized()), k_(k), h_(smoothing) {
    VectorXd area = VectorXd::Zero(mesh.nodes());
    for (Eigen::Index face = 0; face < mesh.boundary.cols(); ++face) {
      MatrixXd x(3, mesh.boundary.rows());
      for (Eigen::Index i = 0; i < x.cols(); ++i) x.col(i) = mesh.X.col(mesh.boundary(i, face));
      for (const FacePoint& g : face_rule(mesh.order)) {
        const Eigen::Matrix<double, 3, 2> t = x * g.dN;
        const double dA = g.weight * t.col(0).cross(t.col(1)).norm();
        for (Eigen::Index i = 0; i < x.cols(); ++i) area[mesh.boundary(i, face)] += g.N[i] * dA;
      }
    }
    const double least = 1e-9 * area.maxCoeff();  // corners of quadratic faces: 0 but for rounding
    for (int a = 0; a < mesh.nodes(); ++a)
      if (area[a] > least) nodes_.emplace_back(a, area[a]);
  }

  double potential(const TetMesh&, const VectorXd& q, double) const override {
    double sum = 0;
    for (const auto& [a, area] : nodes_) {
      const double d = depth(q, a);
      if (d <= 0) continue;
      sum += area * k_ * (d < h_ ? d * d * d / (6 * h_) : d * (d - h_) / 2 + h_ * h_ / 6);
    }
    return sum;
  }
  void add_residual(const TetMesh&, const VectorXd& q, double, VectorXd& R) const override {
    for (const auto& [a, area] : nodes_) {
      const double d = depth(q, a);
      if (d <= 0) continue;
      R.segment<3>(3 * a) -= area * k_ * (d < h_ ? d * d / (2 * h_) : d - h_ / 2) * n_;
    }
  }
  void add_tangent(const TetMesh&, const VectorXd& q, double, Triplets& K) const override {
    for (const auto& [a, area] : nodes_) {
      const double d = depth(q, a);
      if (d <= 0) continue;
      const Eigen::Matrix3d block = (area * k_ * (d < h_ ? d / h_ : 1.0)) * n_ * n_.transpose();
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) K.emplace_back(3 * a + i, 3 * a + j, block(i, j));
    }
  }

 private:
  double depth(const VectorXd& q, int a) const { return -(q.segment<3>(3 * a) - point_).dot(n_); }

  Vector3d point_, n_;
  double k_, h_;
  std::vector<std::pair<int, double>> nodes_;
};

}  // namespace

std::shared_ptr<const ForceTerm> floor_contact(const TetMesh& mesh, const Vector3d& point,
                                               const Vector3d& normal, double k, double smoothing) {
  return std::make_shared<FloorContact>(mesh, point, normal, k, smoothing);
}

}  // namespace hookeye
