// Strain, stress and energy of the elements at their centroid, for pictures and vtu files.
#include <Eigen/Dense>

#include "simulation/energy_parts.h"
#include "simulation/equilibrium.h"
#include "simulation/quadrature.h"

namespace hookeye {
namespace {

Eigen::Matrix<double, 6, 1> six(const Matrix3d& A) {
  Eigen::Matrix<double, 6, 1> v;
  v << A(0, 0), A(1, 1), A(2, 2), A(0, 1), A(1, 2), A(0, 2);
  return v;
}

/// Energy density and first Piola-Kirchhoff stress of the whole model in the middle of elements.
struct Local {
  Eigen::RowVectorXd psi;
  Matrix9Xd P;
};
Local local_response(const EnergyModel& model, const Matrix9Xd& F) {
  const EnergyParts parts(model);
  Local sum{Eigen::RowVectorXd(F.cols()), Matrix9Xd(9, F.cols())};
  Matrix9Xd elastic = F;
  for (int e = 0; e < F.cols(); ++e) {
    sum.psi[e] = parts.psi(e, F.col(e).reshaped(3, 3));
    sum.P.col(e) = parts.P(e, F.col(e).reshaped(3, 3)).reshaped();
    elastic.col(e) /= parts.swelling(e);
  }
  for (const auto& [part, term] : parts.together) {
    const Eigen::RowVectorXd psi = term->psi_of(elastic);
    const Matrix9Xd P = term->P_of(elastic);
    for (int e = 0; e < F.cols(); ++e) {
      const double g = parts.swelling(e), w = EnergyParts::weight(*part, e);
      sum.psi[e] += w * g * g * g * psi[e];
      sum.P.col(e) += w * g * g * P.col(e);
    }
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
  Matrix9Xd all(9, m);
  for (int e = 0; e < m; ++e) {
    for (int i = 0; i < npe; ++i) {
      X.col(i) = mesh.X.col(mesh.elements(i, e));
      x.col(i) = q.segment<3>(3 * mesh.elements(i, e));
    }
    all.col(e) = Matrix3d((x * dN) * Matrix3d(X * dN).inverse()).reshaped();
  }
  const Local local = local_response(energy, all);
  for (int e = 0; e < m; ++e) {
    const Matrix3d F = all.col(e).reshaped(3, 3);
    const double J = F.determinant();
    const Matrix3d P = local.P.col(e).reshaped(3, 3);
    const Matrix3d sigma = P * F.transpose() / J;
    const Matrix3d deviator = sigma - sigma.trace() / 3.0 * Matrix3d::Identity();
    state.green_strain.col(e) = six(0.5 * (F.transpose() * F - Matrix3d::Identity()));
    state.cauchy_stress.col(e) = six(sigma);
    state.von_mises[e] = std::sqrt(1.5 * deviator.squaredNorm());
    state.J[e] = J;
    state.energy_density[e] = local.psi[e];
  }
  return state;
}

}  // namespace hookeye
