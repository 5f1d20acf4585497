// Internal energy, forces and tangent of the elements.
#pragma once

#include "simulation/equilibrium.h"

namespace hookeye {

using Eigen::MatrixXd;

/// Shape gradients of one mesh at its quadrature points and corners, and the sparsity pattern of
/// its tangent. Costs about one assembly; keep it. Holds no reference to the mesh. Throws
/// OutOfMemory.
class Assembly {
 public:
  explicit Assembly(const TetMesh& mesh);

  double energy(const EnergyModel& model, const VectorXd& q) const;
  void add_forces(const EnergyModel& model, const VectorXd& q, VectorXd& R) const;
  MatrixXd element_forces(const EnergyModel& model, const VectorXd& q) const;
  VectorXd dR_dtheta(const EnergyModel& model, const VectorXd& q, int part, int k) const;
  /// All parameters of the part's term in one pass: 3n x size.
  MatrixXd all_dR_dtheta(const EnergyModel& model, const VectorXd& q, int part) const;

  /// Zeros with the pattern of the tangent: full 3x3 blocks of all node pairs that share an
  /// element. That is looked for at the first call.
  SparseMatrix zero_tangent();
  void find_pattern();
  /// Writes the elastic tangent into K, which has the pattern. `projected`: each quadrature
  /// point's dP/dF is made positive semidefinite first (Teran et al. 2005), |eigenvalues|.
  void set_tangent(const EnergyModel& model, const VectorXd& q, bool projected, SparseMatrix& K);

  /// Smallest det F over quadrature points and corners, and where.
  double smallest_J(const VectorXd& q, int* element = nullptr) const;

  /// F at the centroid and, per quadrature point, dN/dX and weight times volume.
  int nodes_per_element() const { return npe_; }
  int elements() const { return static_cast<int>(nodes_.cols()); }
  int points() const { return points_; }
  double volume(int element, int point) const { return volume_[element * points_ + point]; }

 private:
  template <int N>
  struct Kernel;
  template <class Function>
  auto dispatch(Function&& f) const;
  void find_neighbours();
  /// Nonzeros of one column of a node.
  int column_size(int node) const { return 3 * (first_near_[node + 1] - first_near_[node]); }

  int npe_, points_, corners_, n_;
  Eigen::MatrixXi nodes_;          ///< npe x m
  std::vector<double> gradients_;  ///< dN/dX, npe x 3 column-major; points_ then corners_ a piece
  std::vector<double> volume_;     ///< weight * rest volume, per element and point
  /// Nodes that share an element with each, itself among them, ascending: a ninth of the pattern.
  std::vector<int> first_near_, near_;
  std::vector<int> block_;  ///< per element, a + npe b: first value of block (a, b)
};

}  // namespace hookeye
