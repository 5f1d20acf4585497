#include "simulation/rigid_modes.h"

#include <Eigen/Dense>

namespace hookeye {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

RigidModes::RigidModes(const TetMesh& m)
    : mesh(m),
      center(m.X.rowwise().mean()),
      size((m.X.colwise() - center).colwise().norm().maxCoeff()) {}

Eigen::Matrix<double, 6, 1> RigidModes::row(int unknown) const {
  const Vector3d e = Vector3d::Unit(unknown % 3);
  Eigen::Matrix<double, 6, 1> r;
  r << e, ((mesh.X.col(unknown / 3) - center) / size).cross(e);
  return r;
}

Eigen::MatrixXd RigidModes::free(const std::vector<int>& prescribed) const {
  Matrix6d AtA = Matrix6d::Zero();
  for (int u : prescribed) AtA += row(u) * row(u).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(AtA);
  const double least = 1e-10 * std::max(1.0, eigen.eigenvalues()[5]);
  const auto k = (eigen.eigenvalues().array() < least).count();
  return eigen.eigenvectors().leftCols(k);
}

std::vector<int> RigidModes::pins(Eigen::MatrixXd free) const {
  std::vector<int> chosen;
  while (free.cols() > 0) {
    // The unknown that the free motions move most; then drop the motion that it stops.
    int best = 0;
    double most = -1;
    for (int u = 0; u < 3 * mesh.nodes(); ++u) {
      const double moved = (free.transpose() * row(u)).squaredNorm();
      if (moved > most * (1 + 1e-9)) {
        most = moved;
        best = u;
      }
    }
    chosen.push_back(best);
    const VectorXd along = free.transpose() * row(best);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(along);
    const Eigen::MatrixXd Q = qr.householderQ();
    free = (free * Q.rightCols(free.cols() - 1)).eval();
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

double RigidModes::imbalance(const Eigen::MatrixXd& free, const VectorXd& force) const {
  Eigen::Matrix<double, 6, 1> work = Eigen::Matrix<double, 6, 1>::Zero();
  for (int u = 0; u < force.size(); ++u) work += force[u] * row(u);
  const double total = force.lpNorm<1>();
  return total > 0 ? (free.transpose() * work).norm() / total : 0.0;
}

}  // namespace hookeye
