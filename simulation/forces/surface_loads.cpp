// Forces on faces that depend on the deformation: follower pressure and elastic foundation.
#include <Eigen/Dense>
#include <map>

#include "simulation/made_of.h"
#include "simulation/quadrature.h"

namespace hookeye {
namespace {

using Eigen::Matrix3d;
using Tangents = Eigen::Matrix<double, 3, 2>;
using Faces = std::vector<std::pair<int, double>>;

MatrixXd face_nodes(const TetMesh& mesh, const VectorXd& q, int face) {
  MatrixXd x(3, mesh.boundary.rows());
  for (Eigen::Index i = 0; i < x.cols(); ++i) x.col(i) = q.segment<3>(3 * mesh.boundary(i, face));
  return x;
}

Matrix3d skew(const Vector3d& v) {
  Matrix3d S;
  S << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return S;
}

/// Adds the stiffness of one face, summed over its points: each entry is looked up in K once.
void add_face(const TetMesh& mesh, int face, const MatrixXd& stiffness, Triplets& K) {
  const auto unknown = [&](Eigen::Index i) {
    return 3 * mesh.boundary(i / 3, face) + static_cast<int>(i % 3);
  };
  for (Eigen::Index j = 0; j < stiffness.cols(); ++j)
    for (Eigen::Index i = 0; i < stiffness.rows(); ++i)
      K.emplace_back(unknown(i), unknown(j), stiffness(i, j));
}

/// Force -p n da on the deformed faces. On a closed surface it has the potential p V. On an open
/// patch the derivative is unsymmetric by terms along the patch's rim: those of neighbouring faces
/// cancel everywhere else.
class FollowerPressure final : public ForceTerm {
 public:
  FollowerPressure(Faces faces, double pressure) : faces_(std::move(faces)), p_(pressure) {}
  PressureOn made_of() const { return {faces_, p_}; }

  double potential(const TetMesh& mesh, const VectorXd& q, double s) const override {
    return closed(mesh) ? s * p_ * (volume(mesh, q) - volume(mesh, mesh.X.reshaped())) : 0.0;
  }
  /// A term cannot see its mesh here, so only potential() knows whether the patch is closed.
  bool has_potential() const override { return false; }

  void add_residual(const TetMesh& mesh, const VectorXd& q, double s, VectorXd& R) const override {
    for (const auto& [face, fraction] : faces_) {
      const MatrixXd x = face_nodes(mesh, q, face);
      for (const FacePoint& g : face_rule(mesh.order)) {
        const Tangents t = x * g.dN;
        const Vector3d f = (s * p_ * fraction * g.weight) * t.col(0).cross(t.col(1));
        for (Eigen::Index a = 0; a < x.cols(); ++a)
          R.segment<3>(3 * mesh.boundary(a, face)) += g.N[a] * f;
      }
    }
  }

  void add_tangent(const TetMesh& mesh, const VectorXd& q, double s, Triplets& K) const override {
    for (const auto& face : faces_) {
      const MatrixXd D = derivative(mesh, q, s, face);
      add_face(mesh, face.first, 0.5 * (D + D.transpose()), K);
    }
  }

  void add_skew_tangent(const TetMesh& mesh, const VectorXd& q, double s,
                        Triplets& W) const override {
    if (p_ == 0 || closed(mesh)) return;
    for (const auto& face : faces_) {
      const MatrixXd D = derivative(mesh, q, s, face);
      add_face(mesh, face.first, 0.5 * (D - D.transpose()), W);
    }
  }

 private:
  /// d(-force)/dq of one face by its nodes, unsymmetric:
  /// d(t0 x t1) = dt0 x t1 + t0 x dt1 = (-[t1] N_b,0 + [t0] N_b,1) dq_b.
  MatrixXd derivative(const TetMesh& mesh, const VectorXd& q, double s,
                      const Faces::value_type& face) const {
    const MatrixXd x = face_nodes(mesh, q, face.first);
    MatrixXd D = MatrixXd::Zero(x.size(), x.size());
    for (const FacePoint& g : face_rule(mesh.order)) {
      const Tangents t = x * g.dN;
      const Matrix3d S0 = skew(t.col(0)), S1 = skew(t.col(1));
      const double w = s * p_ * face.second * g.weight;
      for (Eigen::Index a = 0; a < x.cols(); ++a)
        for (Eigen::Index b = 0; b < x.cols(); ++b)
          D.block<3, 3>(3 * a, 3 * b) += w * g.N[a] * (g.dN(b, 1) * S0 - g.dN(b, 0) * S1);
    }
    return D;
  }
  double volume(const TetMesh& mesh, const VectorXd& q) const {
    double sum = 0;
    for (const auto& [face, fraction] : faces_) {
      const MatrixXd x = face_nodes(mesh, q, face);
      for (const FacePoint& g : face_rule(mesh.order)) {
        const Tangents t = x * g.dN;
        sum += g.weight * fraction * (x * g.N).dot(t.col(0).cross(t.col(1))) / 3.0;
      }
    }
    return sum;
  }
  bool closed(const TetMesh& mesh) const {
    std::map<std::pair<int, int>, int> edges;
    for (const auto& [face, fraction] : faces_) {
      if (fraction < 1 - 1e-9) return false;
      for (int i = 0; i < 3; ++i) {
        const int a = mesh.boundary(i, face), b = mesh.boundary((i + 1) % 3, face);
        edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      }
    }
    for (const auto& [edge, balance] : edges)
      if (balance != 0) return false;
    return !edges.empty();
  }

  Faces faces_;
  double p_;
};

/// Potential 1/2 integral u.(k_n n n + k_t (1 - n n)).u dA over the rest patch, u interpolated by
/// the faces' shape functions: positive semidefinite, where lumping by nodal areas would leave
/// corner nodes of quadratic faces (area 0) without a spring.
class ElasticFoundation final : public ForceTerm {
 public:
  ElasticFoundation(Faces faces, double kn, double kt, VectorXd target)
      : faces_(std::move(faces)), kn_(kn), kt_(kt), target_(std::move(target)) {}
  FoundationOn made_of() const { return {faces_, kn_, kt_, target_}; }

  double potential(const TetMesh& mesh, const VectorXd& q, double) const override {
    double sum = 0;
    const VectorXd moved = q - target_;
    for (const auto& face : faces_) {
      const MatrixXd at = face_nodes(mesh, moved, face.first);
      visit(mesh, face, [&](const FacePoint& g, const Matrix3d& k) {
        const Vector3d u = at * g.N;
        sum += 0.5 * u.dot(k * u);
      });
    }
    return sum;
  }
  void add_residual(const TetMesh& mesh, const VectorXd& q, double, VectorXd& R) const override {
    const VectorXd moved = q - target_;
    for (const auto& face : faces_) {
      const MatrixXd at = face_nodes(mesh, moved, face.first);
      visit(mesh, face, [&](const FacePoint& g, const Matrix3d& k) {
        const Vector3d t = k * (at * g.N);
        for (Eigen::Index a = 0; a < g.N.size(); ++a)
          R.segment<3>(3 * mesh.boundary(a, face.first)) += g.N[a] * t;
      });
    }
  }
  void add_tangent(const TetMesh& mesh, const VectorXd&, double, Triplets& K) const override {
    const Eigen::Index size = 3 * mesh.boundary.rows();
    for (const auto& face : faces_) {
      MatrixXd stiffness = MatrixXd::Zero(size, size);
      visit(mesh, face, [&](const FacePoint& g, const Matrix3d& k) {
        for (Eigen::Index a = 0; a < g.N.size(); ++a)
          for (Eigen::Index b = 0; b < g.N.size(); ++b)
            stiffness.block<3, 3>(3 * a, 3 * b) += g.N[a] * g.N[b] * k;
      });
      add_face(mesh, face.first, stiffness, K);
    }
  }

 private:
  /// The points of a face with their share of the stiffness.
  template <class F>
  void visit(const TetMesh& mesh, const Faces::value_type& face, F&& f) const {
    const MatrixXd x = mesh.X(Eigen::all, mesh.boundary.col(face.first));
    for (const FacePoint& g : face_rule(mesh.order)) {
      const Tangents t = x * g.dN;
      const Vector3d normal = t.col(0).cross(t.col(1));
      const Vector3d n = normal.normalized();
      const Matrix3d nn = n * n.transpose();
      f(g, Matrix3d((face.second * g.weight * normal.norm()) *
                    (kn_ * nn + kt_ * (Matrix3d::Identity() - nn))));
    }
  }

  Faces faces_;
  double kn_, kt_;
  VectorXd target_;
};

}  // namespace

std::shared_ptr<const ForceTerm> follower_pressure(const Region& region, double pressure) {
  return std::make_shared<FollowerPressure>(region.faces, pressure);
}

std::shared_ptr<const ForceTerm> elastic_foundation(const Region& region, double k_normal,
                                                    double k_tangent, VectorXd target) {
  return std::make_shared<ElasticFoundation>(region.faces, k_normal, k_tangent, std::move(target));
}

std::optional<PressureOn> as_pressure(const ForceTerm& force) {
  const auto* own = dynamic_cast<const FollowerPressure*>(&force);
  return own ? std::optional(own->made_of()) : std::nullopt;
}

std::optional<FoundationOn> as_foundation(const ForceTerm& force) {
  const auto* own = dynamic_cast<const ElasticFoundation*>(&force);
  return own ? std::optional(own->made_of()) : std::nullopt;
}

}  // namespace hookeye
