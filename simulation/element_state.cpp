// Strain, stress and energy of the elements at their centroid, for pictures and vtu files.
#include <Eigen/Dense>

#include "simulation/equilibrium.h"
#include "simulation/quadrature.h"

namespace hookeye {
namespace {

Eigen::Matrix<double, 6, 1> six(const Matrix3d& A) {
  Eigen::Matrix<double, 6, 1> v;
  v << A(0, 0), A(1, 1), A(2, 2), A(0, 1), A(1, 2), A(0, 2);
  return v;
}

/// Energy density and first Piola-Kirchhoff stress of the whole model in one element.
struct Local {
  double psi = 0;
  Matrix3d P = Matrix3d::Zero();
};
Local local_response(const EnergyModel& model, int e, const Matrix3d& F) {
  const double g = model.swelling.size() ? model.swelling[e] : 1.0;
  Local sum;
  for (const auto& part : model.parts) {
    const double w = part.weight.size() ? part.weight[e] : 1.0;
    sum.psi += w * g * g * g * part.psi(e, F / g);
    sum.P += w * g * g * part.P(e, F / g);
  }
  return sum;
}

}  // namespace

std::vector<Matrix3d> deformation_gradients(const TetMesh& mesh, const VectorXd& q) {
  std::vector<MatrixXd> dN;
  for (const auto& point : stiffness_rule(mesh.order).points)
    dN.push_back(shape_derivatives(mesh.order, point));
  const int npe = mesh.nodes_per_element();
  std::vector<Matrix3d> all;
  all.reserve(dN.size() * static_cast<size_t>(mesh.size()));
  MatrixXd X(3, npe), x(3, npe);
  for (int e = 0; e < mesh.size(); ++e) {
    for (int i = 0; i < npe; ++i) {
      X.col(i) = mesh.X.col(mesh.elements(i, e));
      x.col(i) = q.segment<3>(3 * mesh.elements(i, e));
    }
    for (const MatrixXd& d : dN) all.push_back((x * d) * Matrix3d(X * d).inverse());
  }
  return all;
}

ElementState element_state(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q) {
  const MatrixXd dN = shape_derivatives(mesh.order, Eigen::Vector4d::Constant(0.25));
  const int npe = mesh.nodes_per_element(), m = mesh.size();
  ElementState state;
  state.green_strain.resize(6, m);
  state.cauchy_stress.resize(6, m);
  state.von_mises.resize(m);
  state.J.resize(m);
  state.energy_density.resize(m);
  MatrixXd X(3, npe), x(3, npe);
  for (int e = 0; e < m; ++e) {
    for (int i = 0; i < npe; ++i) {
      X.col(i) = mesh.X.col(mesh.elements(i, e));
      x.col(i) = q.segment<3>(3 * mesh.elements(i, e));
    }
    const Matrix3d F = (x * dN) * Matrix3d(X * dN).inverse();
    const Local local = local_response(energy, e, F);
    const double J = F.determinant();
    const Matrix3d sigma = local.P * F.transpose() / J;
    const Matrix3d deviator = sigma - sigma.trace() / 3.0 * Matrix3d::Identity();
    state.green_strain.col(e) = six(0.5 * (F.transpose() * F - Matrix3d::Identity()));
    state.cauchy_stress.col(e) = six(sigma);
    state.von_mises[e] = std::sqrt(1.5 * deviator.squaredNorm());
    state.J[e] = J;
    state.energy_density[e] = local.psi;
  }
  return state;
}

}  // namespace hookeye
