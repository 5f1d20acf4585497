// Solves with the free unknowns' tangent: by sparse Cholesky, or by what stands in for it where
// that is too large (large_solver.h).
#pragma once

#include <memory>

#include "simulation/equilibrium.h"

namespace hookeye {

using Eigen::MatrixXd;
struct LargeBody;

/// What a numeric factorization takes [bytes]: the factor itself, and beside it while it runs.
struct FactorMemory {
  double factor = 0.0, beside = 0.0;
};

/// Fill-reducing order and symbolic factor for one pattern of K and one set of free unknowns.
/// Shared by all numeric factors of it. Indices of the factor have 64 bits.
class SymbolicFactor {
 public:
  /// `K` full symmetric, 3 unknowns a node; `free` ascending. `ends`: LargeBody::ends, with which
  /// iterations may be chosen instead of a factor (use_large_solver()). Throws OutOfMemory.
  SymbolicFactor(const SparseMatrix& K, std::vector<int> free,
                 const Eigen::Matrix2Xi& ends = Eigen::Matrix2Xi(2, 0));
  ~SymbolicFactor();
  const std::vector<int>& free() const;
  bool fits(const SparseMatrix& K, const std::vector<int>& free) const;
  /// Known before anything is factored. Of iterations: what they hold, nearly.
  FactorMemory memory() const;
  /// Null: there is a factor.
  const std::shared_ptr<const LargeBody>& large() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// L L^T = P K_ff P^T. Where K_ff is not positive definite: L D L^T without pivoting (slower;
/// `positive()` is false). Not thread-safe: solves share a workspace. Where it `iterates()` solves
/// are dear, and a new tangent costs less than one.
class TangentFactor {
 public:
  explicit TangentFactor(std::shared_ptr<const SymbolicFactor> symbolic);
  ~TangentFactor();

  /// Numeric factorization of K_ff (+ shift on the diagonal). Returns false where a pivot is not
  /// positive (the factor is then unusable). Throws OutOfMemory before it takes what is not there.
  /// For iterations `q` tells where K was assembled (3n), and unless `surely` a K_ff that is not
  /// positive definite may be found by solve_within() only.
  bool factorize(const SparseMatrix& K, double shift = 0.0, const VectorXd& q = {},
                 bool surely = true);
  /// L D L^T of an indefinite matrix. False: a zero pivot, singular. Throws OutOfMemory likewise.
  bool factorize_indefinite(const SparseMatrix& K);
  bool positive() const;
  bool iterates() const;

  /// X = K_ff^-1 B, nf x m, by blocks of right-hand sides.
  void solve(const MatrixXd& B, MatrixXd& X) const;
  void solve(const VectorXd& b, VectorXd& x) const;
  /// The same, by iterations with |r| <= tolerance |b| in the norm of K_ff^-1. False: K_ff has
  /// shown itself not to be positive definite.
  bool solve_within(const VectorXd& b, double tolerance, VectorXd& x) const;
  const std::vector<int>& free() const { return symbolic_->free(); }
  const std::shared_ptr<const SymbolicFactor>& symbolic() const { return symbolic_; }
  double factor_nonzeros() const;
  /// A new one, without values, that knows what this one has learned of the body.
  std::shared_ptr<TangentFactor> another() const;

 private:
  struct Impl;
  std::shared_ptr<const SymbolicFactor> symbolic_;
  std::unique_ptr<Impl> impl_;
};

/// Of all numeric factors that are alive [bytes].
double memory_of_factors();

}  // namespace hookeye
