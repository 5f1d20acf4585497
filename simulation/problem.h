// One equilibrium problem: mesh, energy and loading bound together.
#pragma once

#include "simulation/assembly.h"

namespace hookeye {

/// References must outlive it.
struct Problem {
  const TetMesh& mesh;
  Assembly& assembly;
  const EnergyModel& energy;
  const Loading& loading;
  /// A force that holds the body where a climb begins under load (3n): 1 - s of it at fraction s,
  /// while the other forces do not grow. Where an obstacle has moved that place is no equilibrium,
  /// and without such a force no load step would be short enough (homotopy of the residual:
  /// Allgower and Georg, Introduction to Numerical Continuation Methods, 2003, 1.2). Null: none,
  /// the forces grow with s.
  const VectorXd* held_by = nullptr;

  double load(double s) const { return held_by ? 1.0 : s; }
  bool has_potential() const;
  double potential(const VectorXd& q, double s) const;
  VectorXd residual(const VectorXd& q, double s) const;
  /// External forces only, -sum add_residual(q): what the tolerance is measured against.
  VectorXd external(const VectorXd& q, double s) const;
  /// Symmetric part of the tangent.
  void tangent(const VectorXd& q, double s, bool projected, SparseMatrix& K) const;
  /// Skew part, 3n x 3n or 0 x 0; no values where the tangent is symmetric.
  SparseMatrix skew_tangent(const VectorXd& q, double s) const;
  std::vector<int> free_unknowns() const;
};

/// K += triplets; the pattern grows only where it must.
void add_triplets(const Triplets& triplets, SparseMatrix& K);

/// K + W, W of few values that K's pattern has.
SparseMatrix sum(const SparseMatrix& K, const SparseMatrix& W);
/// W_ff of a W of few values.
SparseMatrix free_block(const SparseMatrix& W, const std::vector<int>& free);

/// The chosen unknowns of all, and back: zero on the others.
VectorXd select(const VectorXd& all, const std::vector<int>& unknowns);
VectorXd spread(const VectorXd& some, const std::vector<int>& unknowns, Eigen::Index size);

}  // namespace hookeye
