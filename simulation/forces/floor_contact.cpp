// Rigid floor by a smoothed penalty on boundary faces.
#include <Eigen/Dense>

#include "simulation/made_of.h"
#include "simulation/quadrature.h"

namespace hookeye {
namespace {

/// Potential int k phi(d) dA over the rest boundary, depth d = -(x - point).n, with phi'(d) = 0 for
/// d < 0, d^2/(2h) up to the smoothing depth h, d - h/2 beyond. Over faces and not lumped to nodes:
/// consistent areas of quadratic faces are all at mid nodes, with which an edge or a corner of the
/// body would pass through the floor.
class FloorContact final : public ForceTerm {
 public:
  FloorContact(const TetMesh& mesh, const Vector3d& point, const Vector3d& normal, double k,
               double smoothing)
      : rule_(fine_face_rule(mesh.order)),
        dA_(static_cast<Eigen::Index>(rule_.size()), mesh.boundary.cols()),
        point_(point),
        n_(normal.normalized()),
        k_(k),
        h_(smoothing) {
    for (Eigen::Index face = 0; face < mesh.boundary.cols(); ++face) {
      MatrixXd x(3, mesh.boundary.rows());
      for (Eigen::Index a = 0; a < x.cols(); ++a) x.col(a) = mesh.X.col(mesh.boundary(a, face));
      for (size_t g = 0; g < rule_.size(); ++g) {
        const Eigen::Matrix<double, 3, 2> t = x * rule_[g].dN;
        dA_(static_cast<Eigen::Index>(g), face) = rule_[g].weight * t.col(0).cross(t.col(1)).norm();
      }
    }
  }

  FloorPlane made_of() const { return {point_, n_, k_, h_}; }

  double potential(const TetMesh& mesh, const VectorXd& q, double) const override {
    double sum = 0;
    each_face(mesh, q, [&](Eigen::Index face, const VectorXd& depths) {
      each_point(face, depths, [&](const VectorXd&, double dA, double d) {
        sum += dA * k_ * (d < h_ ? d * d * d / (6 * h_) : d * (d - h_) / 2 + h_ * h_ / 6);
      });
    });
    return sum;
  }
  void add_residual(const TetMesh& mesh, const VectorXd& q, double, VectorXd& R) const override {
    each_face(mesh, q, [&](Eigen::Index face, const VectorXd& depths) {
      each_point(face, depths, [&](const VectorXd& N, double dA, double d) {
        const double f = dA * k_ * (d < h_ ? d * d / (2 * h_) : d - h_ / 2);
        for (Eigen::Index a = 0; a < N.size(); ++a)
          R.segment<3>(3 * mesh.boundary(a, face)) -= N[a] * f * n_;
      });
    });
  }
  void add_tangent(const TetMesh& mesh, const VectorXd& q, double, Triplets& K) const override {
    const Eigen::Matrix3d nn = n_ * n_.transpose();
    each_face(mesh, q, [&](Eigen::Index face, const VectorXd& depths) {
      MatrixXd along = MatrixXd::Zero(depths.size(), depths.size());
      each_point(face, depths, [&](const VectorXd& N, double dA, double d) {
        along += (dA * k_ * (d < h_ ? d / h_ : 1.0)) * N * N.transpose();
      });
      for (Eigen::Index b = 0; b < along.cols(); ++b)
        for (Eigen::Index a = 0; a < along.rows(); ++a)
          for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
              K.emplace_back(3 * mesh.boundary(a, face) + i, 3 * mesh.boundary(b, face) + j,
                             along(a, b) * nn(i, j));
    });
  }

 private:
  /// visit(face, depths of its nodes), those that may reach through the plane: between its nodes a
  /// quadratic face is deeper than the deepest by less than they differ.
  template <class Visit>
  void each_face(const TetMesh& mesh, const VectorXd& q, const Visit& visit) const {
    VectorXd d(mesh.boundary.rows());
    for (Eigen::Index face = 0; face < mesh.boundary.cols(); ++face) {
      for (Eigen::Index a = 0; a < d.size(); ++a)
        d[a] = -(q.segment<3>(3 * mesh.boundary(a, face)) - point_).dot(n_);
      if (2 * d.maxCoeff() > d.minCoeff()) visit(face, d);
    }
  }
  /// visit(shape functions, rest area, depth) of each point beyond the plane.
  template <class Visit>
  void each_point(Eigen::Index face, const VectorXd& depths, const Visit& visit) const {
    for (size_t g = 0; g < rule_.size(); ++g)
      if (const double d = rule_[g].N.dot(depths); d > 0)
        visit(rule_[g].N, dA_(static_cast<Eigen::Index>(g), face), d);
  }

  const std::vector<FacePoint>& rule_;
  MatrixXd dA_;  ///< points x faces
  Vector3d point_, n_;
  double k_, h_;
};

}  // namespace

std::shared_ptr<const ForceTerm> floor_contact(const TetMesh& mesh, const Vector3d& point,
                                               const Vector3d& normal, double k, double smoothing) {
  return std::make_shared<FloorContact>(mesh, point, normal, k, smoothing);
}

std::optional<FloorPlane> as_floor(const ForceTerm& force) {
  const auto* own = dynamic_cast<const FloorContact*>(&force);
  return own ? std::optional(own->made_of()) : std::nullopt;
}

}  // namespace hookeye
