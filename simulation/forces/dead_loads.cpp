// Forces that do not depend on the deformation: total force on a region, nodal force, self-weight.
#include "simulation/loading.h"
#include "simulation/quadrature.h"

namespace hookeye {
namespace {

/// Potential -s f.(q - X). Most forces are on a few nodes, and a capture may have a force for each
/// of a thousand load cases.
class DeadLoad final : public ForceTerm {
 public:
  explicit DeadLoad(const VectorXd& force) : force_(force.sparseView()) {}
  double potential(const TetMesh& mesh, const VectorXd& q, double s) const override {
    return -s * VectorXd(force_).dot(q - mesh.X.reshaped());
  }
  void add_residual(const TetMesh&, const VectorXd&, double s, VectorXd& R) const override {
    for (Eigen::SparseVector<double>::InnerIterator one(force_); one; ++one)
      R[one.index()] -= s * one.value();
  }
  void add_tangent(const TetMesh&, const VectorXd&, double, Triplets&) const override {}
  bool dead() const override { return true; }

 private:
  Eigen::SparseVector<double> force_;
};

}  // namespace

std::shared_ptr<const ForceTerm> nodal_force(VectorXd force) {
  return std::make_shared<DeadLoad>(force);
}

std::shared_ptr<const ForceTerm> dead_force(const Region& region, const Vector3d& force) {
  const VectorXd share = region.nodal_area / region.nodal_area.sum();
  return nodal_force((force * share.transpose()).reshaped());
}

std::shared_ptr<const ForceTerm> self_weight(const TetMesh& mesh, double density,
                                             const Vector3d& gravity) {
  // integral N_a dV; for straight order 2: -V/20 at corners, V/5 at mid nodes.
  const TetRule& rule = stiffness_rule(mesh.order);
  VectorXd volume = VectorXd::Zero(mesh.nodes());
  const int npe = mesh.nodes_per_element();
  MatrixXd x(3, npe);
  for (int e = 0; e < mesh.size(); ++e) {
    for (int i = 0; i < npe; ++i) x.col(i) = mesh.X.col(mesh.elements(i, e));
    for (size_t p = 0; p < rule.points.size(); ++p) {
      const Eigen::Matrix3d jacobian = x * shape_derivatives(mesh.order, rule.points[p]);
      const VectorXd N = shape_values(mesh.order, rule.points[p]);
      const double dV = rule.weights[p] * jacobian.determinant() / 6.0;
      for (int i = 0; i < npe; ++i) volume[mesh.elements(i, e)] += N[i] * dV;
    }
  }
  return nodal_force((density * gravity * volume.transpose()).reshaped());
}

}  // namespace hookeye
