// Sparse Cholesky of the free unknowns' tangent.
#pragma once

#include <memory>

#include "simulation/equilibrium.h"

namespace hookeye {

using Eigen::MatrixXd;

/// What a numeric factorization takes [bytes]: the factor itself, and beside it while it runs.
struct FactorMemory {
  double factor = 0.0, beside = 0.0;
};

/// Fill-reducing order and symbolic factor for one pattern of K and one set of free unknowns.
/// Shared by all numeric factors of it. Indices of the factor have 64 bits.
class SymbolicFactor {
 public:
  /// `K` full symmetric, 3 unknowns a node; `free` ascending. Throws OutOfMemory.
  SymbolicFactor(const SparseMatrix& K, std::vector<int> free);
  ~SymbolicFactor();
  const std::vector<int>& free() const;
  bool fits(const SparseMatrix& K, const std::vector<int>& free) const;
  /// Known before anything is factored.
  FactorMemory memory() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// L L^T = P K_ff P^T. Where K_ff is not positive definite: L D L^T without pivoting (slower;
/// `positive()` is false). Not thread-safe: solves share a workspace.
class TangentFactor {
 public:
  explicit TangentFactor(std::shared_ptr<const SymbolicFactor> symbolic);
  ~TangentFactor();

  /// Numeric factorization of K_ff (+ shift on the diagonal). Returns false where a pivot is not
  /// positive (the factor is then unusable). Throws OutOfMemory before it takes what is not there.
  bool factorize(const SparseMatrix& K, double shift = 0.0);
  /// L D L^T of an indefinite matrix. False: a zero pivot, singular. Throws OutOfMemory likewise.
  bool factorize_indefinite(const SparseMatrix& K);
  bool positive() const;

  /// X = K_ff^-1 B, nf x m, by blocks of right-hand sides.
  void solve(const MatrixXd& B, MatrixXd& X) const;
  void solve(const VectorXd& b, VectorXd& x) const;
  const std::vector<int>& free() const { return symbolic_->free(); }
  const std::shared_ptr<const SymbolicFactor>& symbolic() const { return symbolic_; }
  double factor_nonzeros() const;

 private:
  struct Impl;
  std::shared_ptr<const SymbolicFactor> symbolic_;
  std::unique_ptr<Impl> impl_;
};

/// Of all numeric factors that are alive [bytes].
double memory_of_factors();

}  // namespace hookeye
