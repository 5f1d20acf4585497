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

  bool has_potential() const;
  double potential(const VectorXd& q, double s) const;
  VectorXd residual(const VectorXd& q, double s) const;
  /// External forces only, -sum add_residual(q): what the tolerance is measured against.
  VectorXd external(const VectorXd& q, double s) const;
  void tangent(const VectorXd& q, double s, bool projected, SparseMatrix& K) const;
  std::vector<int> free_unknowns() const;
};

/// K += triplets; the pattern grows only where it must.
void add_triplets(const Triplets& triplets, SparseMatrix& K);

VectorXd select(const VectorXd& all, const std::vector<int>& unknowns);

}  // namespace hookeye
