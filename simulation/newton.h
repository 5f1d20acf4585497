// Newton's method on the free unknowns at a fixed load fraction.
#pragma once

#include <mutex>
#include <string>

#include "core/numerical_failure.h"
#include "simulation/problem.h"
#include "simulation/sparse_factor.h"

namespace hookeye {

/// The symbolic factors that solvers of one mesh have: examples held alike share theirs.
class SymbolicFactors {
 public:
  /// `ends`: of the mesh (large_solver.h); none: factors only.
  explicit SymbolicFactors(Eigen::Matrix2Xi ends = Eigen::Matrix2Xi(2, 0))
      : ends_(std::move(ends)) {}
  /// One that fits, else a new one. Any thread; a second one waits for the first.
  std::shared_ptr<const SymbolicFactor> of(const SparseMatrix& K, const std::vector<int>& free);

 private:
  Eigen::Matrix2Xi ends_;
  std::mutex mutex_;
  std::vector<std::weak_ptr<const SymbolicFactor>> known_;
  /// Two that were asked for last: one solver may go to and fro between examples held in two ways.
  std::vector<std::shared_ptr<const SymbolicFactor>> last_;
};

/// Factors and counters that live across load steps and solves.
struct NewtonState {
  std::vector<int> free;
  std::shared_ptr<SymbolicFactors> shared;  ///< null: of this state alone
  std::shared_ptr<const SymbolicFactor> symbolic;
  std::shared_ptr<TangentFactor> factor;  ///< of some earlier tangent; null: none
  SparseMatrix K;                         ///< last tangent assembled, its symmetric part
  VectorXd at;                            ///< where it was
  double stiffest = 0.0;                  ///< largest on the diagonal of one; 0: none was assembled
  SparseMatrix W;                         ///< its skew part; no values: none
  SparseMatrix W_ff;                      ///< that of K_ff; no values: K_ff is symmetric
  int iterations = 0, factorizations = 0;

  /// Assembles the true tangent at q.
  void set_tangent(const Problem& problem, const VectorXd& q, double s);
  /// Factor of the K at hand: reuses the memory of `factor` unless an Equilibrium holds it.
  /// `surely`: TangentFactor::factorize().
  bool factorize(double shift, bool surely);
};

struct NewtonGoal {
  double s = 1.0;
  double tolerance = 1e-9;  ///< |R_free|_inf over the largest nodal force
  int max_iterations = 60;
  bool reuse_factor = false;  ///< start on the factor at hand, however far
  bool tangent_there = true;  ///< leave the true tangent at the solution in the state
  std::function<bool()> cancelled;
};

struct NewtonOutcome {
  bool converged = false;
  double error = 0.0;  ///< |R_free|_inf over the largest nodal force
  std::string reason;
  NumericalFailure::Kind kind = NumericalFailure::Kind::numbers;  ///< of the reason
};

/// Moves q's free unknowns to equilibrium; prescribed ones stay. q must have det F > 0 everywhere.
/// Where it may start on the factor at hand it steps on that alone first, without a new tangent, as
/// long as that is quicker (the chord method: Kelley, Iterative Methods for Linear and Nonlinear
/// Equations, 1995, 5.4).
NewtonOutcome newton(const Problem& problem, const NewtonGoal& goal, NewtonState& state,
                     VectorXd& q);

/// |R_free|_inf over the largest nodal force: reactions, external forces, and a floor that keeps
/// an unloaded body from dividing rounding by rounding (stiffness times 1e-5 of the size).
double relative_error(const Problem& problem, const NewtonState& state, const VectorXd& R,
                      const VectorXd& q, double s);

}  // namespace hookeye
