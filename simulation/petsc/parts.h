// What multigrid takes from PETSc: algebraic multigrid, and MUMPS.
#pragma once

#include <memory>

#include "simulation/petsc/node_blocks.h"

namespace hookeye {

/// PETSc from its first use to its end, in this process alone. Calls of several threads wait for
/// one another. What PETSc finds wrong is thrown: std::bad_alloc, or std::runtime_error.
class PetscSession {
 public:
  /// Once a process; after MPI_Init where there is one, with threads that may call MPI
  /// (MPI_THREAD_SERIALIZED at least).
  PetscSession();
  /// Nothing of PETSc may be alive any more.
  ~PetscSession();
  PetscSession(const PetscSession&) = delete;
  PetscSession& operator=(const PetscSession&) = delete;
};

/// One cycle of smoothed aggregation (GAMG) with rigid motions as what is nearly free of energy.
class AlgebraicMultigrid {
 public:
  /// `K`: its arrays must stay where they are. `positions`: of the corners as K was assembled, 3n.
  AlgebraicMultigrid(const CornerBlocks& K, const VectorXd& positions);
  ~AlgebraicMultigrid();
  /// z = about K^-1 r, both of K's rows.
  void apply(const double* r, double* z) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// L D L^T with pivoting, in memory or, where there is none, on disk below TMPDIR.
class MumpsFactor {
 public:
  explicit MumpsFactor(const NodeBlocks& K);
  ~MumpsFactor();
  int negative() const;                                            ///< of D
  bool singular() const;                                           ///< nothing can be solved
  void solve(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) const;  ///< 3n x m
  double bytes() const;
  bool on_disk() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
