// Equilibrium of one example and what follows from its factored tangent.
#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <limits>
#include <memory>

#include "core/numerical_failure.h"
#include "simulation/energy_model.h"
#include "simulation/loading.h"

namespace hookeye {

using SparseMatrix = Eigen::SparseMatrix<double>;  ///< column-major, both triangles

/// R(q) = dE_internal/dq + sum of force terms; K = dR/dq. All 3n unknowns, supports not eliminated.
double internal_energy(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q);
VectorXd residual(const TetMesh& mesh, const EnergyModel& energy, const Loading& loading,
                  const VectorXd& q, double load_fraction = 1.0);
SparseMatrix tangent(const TetMesh& mesh, const EnergyModel& energy, const Loading& loading,
                     const VectorXd& q, double load_fraction = 1.0);
/// Internal forces element by element: (3*nodes per element) x m; residual = their sum minus
/// forces.
Eigen::MatrixXd element_forces(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q);
/// d(internal force)/dtheta_k of part `part`'s term at fixed q (3n).
VectorXd dR_dtheta(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q, int part,
                   int k);
/// The same for all of its parameters: 3n x size.
Eigen::MatrixXd all_dR_dtheta(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q,
                              int part);
/// F at the points where the energy is evaluated, element by element (elements x points, point
/// fastest).
std::vector<Matrix3d> deformation_gradients(const TetMesh& mesh, const VectorXd& q);

/// State of the elements for pictures and vtu: at the centroid, 6 x m in the order xx yy zz xy yz
/// xz.
struct ElementState {
  Eigen::MatrixXd green_strain, cauchy_stress;
  VectorXd von_mises, J, energy_density;
};
ElementState element_state(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q);

/// The factored symmetric part of the true tangent on the free unknowns at the solution.
class TangentFactor;

struct Equilibrium {
  VectorXd q;      ///< 3n deformed positions [length]
  VectorXd R;      ///< 3n; zero on free unknowns, on prescribed ones the force the
                   ///< support exerts on the body [force]
  SparseMatrix K;  ///< true tangent at q, 3n x 3n
  std::shared_ptr<const TangentFactor> factor;  ///< of K_ff's symmetric part
  SparseMatrix W_ff;  ///< skew part of K_ff, not in `factor`; no values: no pressure ends at a
                      ///< free rim
  int newton_iterations = 0;
  int factorizations = 0;
  bool stable = true;  ///< K_ff's symmetric part is positive definite
};

struct EquilibriumOptions {
  double tolerance = 1e-9;      ///< |R_free|_inf over the largest nodal force (or reaction)
  int max_iterations = 60;      ///< Newton iterations of one load step
  double smallest_step = 1e-4;  ///< load fraction at which the solver gives up
  /// Newton iterations of all load steps together, from the last solution and again from rest. For
  /// a change of parameters that may be refused: an equilibrium that is there is found in some ten,
  /// one that is not can be sought for hundreds.
  int most_iterations = std::numeric_limits<int>::max();
  /// Leave the factored tangent, which sensitivities() needs. False: Equilibrium::factor is null
  /// and `stable` is not known, but true.
  bool factored = true;
  /// Where the solution is expected (3n), as last solution + S dp: a warm start begins there where
  /// that leaves less out of balance than the last solution does. Null: not known.
  const VectorXd* expected = nullptr;
  std::function<bool()> cancelled;  ///< polled; true: returns a failure "cancelled"
};

/// Keeps the symbolic factorization of one mesh and set of free unknowns (METIS on the node graph),
/// and the last solution and factor for warm starts. Not thread-safe; one per example.
class EquilibriumSolver {
 public:
  explicit EquilibriumSolver(std::shared_ptr<const TetMesh> mesh);
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;

  /// Finds R_free(q) = 0. Warm start from the last solution of this solver, else from `start`
  /// (3n) if given, else from rest by adaptive load steps. No inverted element is ever accepted.
  /// After small changes the last factor preconditions conjugate gradients.
  Result<Equilibrium> solve(const EnergyModel& energy, const Loading& loading,
                            const EquilibriumOptions& options = {},
                            const VectorXd* start = nullptr);
  void forget();  ///< drops the warm start

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One-shot form.
Result<Equilibrium> solve_equilibrium(const TetMesh& mesh, const EnergyModel& energy,
                                      const Loading& loading,
                                      const EquilibriumOptions& options = {});

/// S = dq/dp for columns given by dR/dp at fixed q (3n x m, at all unknowns) and the change of the
/// prescribed unknowns dq_c/dp (rows in the order of loading.prescribed; empty: none):
///   S_c = dq_c/dp,  S_f = -K_ff^-1 (dR_f/dp + K_fc S_c).   Returns 3n x m.
/// Where K_ff is unsymmetric the factor preconditions, and a column costs some ten solves.
Eigen::MatrixXd sensitivities(const Equilibrium& equilibrium, const Loading& loading,
                              const Eigen::MatrixXd& dR_dp, const Eigen::MatrixXd& dqc_dp);

/// Force and moment the supports exert on the body through the region's nodes:
/// force = sum_a R_a, moment = sum_a (q_a - about) x R_a  [force], [force length].
Vector3d support_force(const Equilibrium& equilibrium, const Region& region);
Vector3d support_moment(const Equilibrium& equilibrium, const Region& region,
                        const Vector3d& about);
/// Their derivatives by parameters, 3 x m, from dR/dp at fixed q and S = dq/dp (3n x m):
/// dR = dR/dp + K S.
Eigen::MatrixXd d_support_force(const Equilibrium& equilibrium, const Region& region,
                                const Eigen::MatrixXd& dR_dp, const Eigen::MatrixXd& S);
Eigen::MatrixXd d_support_moment(const Equilibrium& equilibrium, const Region& region,
                                 const Vector3d& about, const Eigen::MatrixXd& dR_dp,
                                 const Eigen::MatrixXd& S);

}  // namespace hookeye
