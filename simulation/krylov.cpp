#include "simulation/krylov.h"

#include <unsupported/Eigen/IterativeSolvers>

#include "simulation/problem.h"

namespace hookeye {

int conjugate_gradients(const SparseMatrix& K, const TangentFactor& factor, const VectorXd& b,
                        double tolerance, int max_iterations, VectorXd& x) {
  const std::vector<int>& free = factor.free();
  VectorXd r = b, z, Kp;
  factor.solve(r, z);
  x = VectorXd::Zero(b.size());
  VectorXd p = z;
  double rz = r.dot(z);
  const double goal = tolerance * tolerance * rz;  // |r| in the norm of K^-1: soft modes count
  if (rz == 0) return 1;
  for (int i = 1; i <= max_iterations; ++i) {
    Kp = select(K * spread(p, free, K.cols()), free);
    const double curvature = p.dot(Kp);
    if (!(curvature > 0) || !(rz > 0)) return -1;
    const double alpha = rz / curvature;
    x += alpha * p;
    r -= alpha * Kp;
    factor.solve(r, z);
    const double next = r.dot(z);
    if (next <= goal) return i;
    p = z + (next / rz) * p;
    rz = next;
  }
  return -1;
}

int skew_gradients(const SparseMatrix& W, const TangentFactor& H, const MatrixXd& B,
                   double tolerance, int max_iterations, MatrixXd& X) {
  MatrixXd x = MatrixXd::Zero(B.rows(), B.cols()), x_last = x, r = B, r_last = x, z;
  Eigen::RowVectorXd omega = Eigen::RowVectorXd::Ones(B.cols()), rho, rho_last, goal;
  for (int i = 0; i <= max_iterations; ++i) {
    H.solve(r, z);
    rho = r.cwiseProduct(z).colwise().sum();
    if (i == 0) goal = tolerance * tolerance * rho;
    if ((rho.array() <= goal.array()).all()) {
      X = std::move(x);
      return i;
    }
    for (Eigen::Index j = 0; j < B.cols(); ++j) {
      if (rho[j] <= goal[j]) {  // done: the steps below leave it where it is
        z.col(j).setZero();
        r_last.col(j).setZero();
        omega[j] = 1;
      } else if (i > 0) {
        omega[j] = 1 / (1 + rho[j] / (rho_last[j] * omega[j]));
      }
    }
    const Eigen::RowVectorXd rest = Eigen::RowVectorXd::Ones(B.cols()) - omega;
    x_last = x_last * rest.asDiagonal() + (x + z) * omega.asDiagonal();
    // B - (H + W) x, as H z = r.
    r_last = r_last * rest.asDiagonal() - (W * z) * omega.asDiagonal();
    x.swap(x_last);
    r.swap(r_last);
    rho_last.swap(rho);
  }
  return -1;
}

namespace {

/// M^-1 on the free unknowns, zero on the prescribed ones: with it Eigen's GMRES on the whole of K
/// never leaves the free unknowns, and K_ff need not be cut out.
class FactorPreconditioner {
 public:
  const TangentFactor* factor = nullptr;

  template <class Matrix>
  FactorPreconditioner& compute(const Matrix&) {
    return *this;
  }
  VectorXd solve(const VectorXd& r) const {
    VectorXd z;
    factor->solve(select(r, factor->free()), z);
    return spread(z, factor->free(), r.size());
  }
  Eigen::ComputationInfo info() const { return Eigen::Success; }
};

}  // namespace

int gmres(const SparseMatrix& K, const TangentFactor& factor, const VectorXd& b, double tolerance,
          int max_iterations, VectorXd& x) {
  Eigen::GMRES<SparseMatrix, FactorPreconditioner> solver;
  solver.preconditioner().factor = &factor;
  solver.compute(K);
  solver.setTolerance(tolerance);
  solver.setMaxIterations(max_iterations);
  solver.set_restart(std::min(max_iterations, 50));
  x = select(solver.solve(spread(b, factor.free(), K.cols())), factor.free());
  return solver.info() == Eigen::Success ? static_cast<int>(solver.iterations()) : -1;
}

}  // namespace hookeye
