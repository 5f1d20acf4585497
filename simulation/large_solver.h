// What stands in for the Cholesky factor of a tangent that is too large for one.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "simulation/equilibrium.h"

namespace hookeye {

/// One body held in one way.
struct LargeBody {
  std::vector<int> free;  ///< unknowns that move, ascending
  /// Per node the two corners of tetrahedra that it lies between; of a corner twice itself.
  Eigen::Matrix2Xi ends;
};

/// Solves K_ff x = b by iteration. Not thread-safe; several may work at once.
class LargeSolver {
 public:
  virtual ~LargeSolver() = default;
  /// Takes K (+ shift on the diagonal), assembled at the positions q (3n): K may go afterwards.
  /// False: K_ff is not positive definite. `surely`: that is looked for; else it may be found by
  /// solve() only. Throws OutOfMemory.
  virtual bool set_up(const SparseMatrix& K, double shift, const VectorXd& q, bool surely) = 0;
  /// Of an indefinite K, solved exactly from then on. False: it is singular.
  virtual bool set_up_indefinite(const SparseMatrix& K) = 0;
  /// X = about K_ff^-1 B, nf x m: |r| <= tolerance |b| in the norm of K^-1 in each column. False:
  /// K_ff is not positive definite, and X means nothing. Where iterations stagnate it is factored.
  virtual bool solve(const Eigen::MatrixXd& B, double tolerance, Eigen::MatrixXd& X) = 0;
  /// The same without an answer of false, whatever K is.
  virtual void solve_exactly(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) = 0;
  /// What it holds.
  virtual double bytes() const = 0;
  /// A new one of the same body that knows what this one has learned of it.
  virtual std::unique_ptr<LargeSolver> another() const = 0;
};

enum class SolverChoice {
  automatic,  ///< a factor where there is memory for it
  direct,     ///< always a factor
  multigrid,  ///< never
};

using MakeLargeSolver =
    std::function<std::unique_ptr<LargeSolver>(std::shared_ptr<const LargeBody>)>;

/// All tangents from now on. Before anything is solved; null: factors only, as in the beginning.
void use_large_solver(SolverChoice when, MakeLargeSolver make);

struct LargeSolvers {
  SolverChoice when = SolverChoice::direct;
  MakeLargeSolver make;
};
const LargeSolvers& large_solvers();

/// LargeBody::ends of a mesh.
Eigen::Matrix2Xi ends_of(const TetMesh& mesh);
/// What analysis and factor of a compact body (a block) take, roughly [bytes]: 14 million values at
/// 30,000 unknowns. Slender ones take less.
double factor_estimate(double unknowns);

}  // namespace hookeye
