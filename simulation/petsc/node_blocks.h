// A tangent as multigrid has it: in blocks of 3 x 3 a pair of nodes.
#pragma once

#include "simulation/large_solver.h"

namespace hookeye {

/// M right-hand sides beside each other: M x 3n, so that a value of K serves all of them.
template <int M>
using Vectors = Eigen::Matrix<double, M, Eigen::Dynamic>;

/// K + shift on the diagonal, blocks on and above the diagonal of rows of nodes (block compressed
/// rows, each block column by column). Unknowns that are not free are coupled to nothing and have a
/// diagonal as large as the others.
class NodeBlocks {
 public:
  NodeBlocks(const SparseMatrix& K, const std::vector<int>& free);
  void take(const SparseMatrix& K, double shift);

  int nodes() const { return static_cast<int>(start_.size()) - 1; }
  bool free(int unknown) const { return free_[unknown] != 0; }
  /// On the diagonal of unknowns that are not free.
  double held_diagonal() const { return held_diagonal_; }
  const std::vector<int>& start() const { return start_; }
  const std::vector<int>& column() const { return column_; }
  const std::vector<double>& values() const { return values_; }
  double bytes() const;

  /// y = K x, with the values told: these or rounded ones.
  template <class Real, int M>
  void multiply(const std::vector<Real>& values, const Vectors<M>& x, Vectors<M>& y) const;

 private:
  std::vector<char> free_;
  std::vector<int> start_, column_;
  std::vector<double> values_;
  double held_diagonal_ = 1.0;
};

template <class Real, int M>
void NodeBlocks::multiply(const std::vector<Real>& values, const Vectors<M>& x,
                          Vectors<M>& y) const {
  using Node = Eigen::Matrix<double, M, 3>;
  y.setZero(M, x.cols());
  for (int a = 0; a < nodes(); ++a) {
    const Node x_a = x.template middleCols<3>(3 * a);
    Node y_a = Node::Zero();
    for (int k = start_[a]; k < start_[a + 1]; ++k) {
      const int b = column_[k];
      const Eigen::Matrix3d K =
          Eigen::Map<const Eigen::Matrix<Real, 3, 3>>(values.data() + 9 * static_cast<size_t>(k))
              .template cast<double>();
      y_a.noalias() += x.template middleCols<3>(3 * b).lazyProduct(K.transpose());
      if (b != a) y.template middleCols<3>(3 * b).noalias() += x_a.lazyProduct(K);
    }
    y.template middleCols<3>(3 * a) += y_a;
  }
}

/// K on the linear tetrahedra of the same corners, P^T K P: where a midside node moves as the mean
/// of its corners. Linear elements have it as it is.
class CornerBlocks {
 public:
  CornerBlocks(const SparseMatrix& K, const NodeBlocks& blocks, const Eigen::Matrix2Xi& ends);
  void take(const SparseMatrix& K, double shift, const NodeBlocks& blocks);

  int corners() const { return static_cast<int>(node_.size()); }
  /// All nodes are corners: the elements are linear, and nothing is to be prolonged.
  bool all() const { return corners() == ends_.cols(); }
  int node(int corner) const { return node_[corner]; }
  /// Compressed rows of unknowns, both triangles.
  const std::vector<int>& start() const { return start_; }
  const std::vector<int>& column() const { return column_; }
  const std::vector<double>& values() const { return values_; }
  double bytes() const;

  /// y += P x, and P^T x; unknowns that are not free, of corners or nodes, have no part in it.
  template <int M>
  void add_prolonged(const NodeBlocks& blocks, Vectors<M> x, Vectors<M>& y) const {
    hold(blocks, x);
    for (Eigen::Index a = 0; a < ends_.cols(); ++a)
      for (int i = 0; i < 3; ++i)
        if (blocks.free(3 * static_cast<int>(a) + i))
          y.col(3 * a + i) +=
              0.5 * (x.col(3 * of_node_[ends_(0, a)] + i) + x.col(3 * of_node_[ends_(1, a)] + i));
  }
  template <int M>
  Vectors<M> restricted(const NodeBlocks& blocks, const Vectors<M>& x) const {
    Vectors<M> y = Vectors<M>::Zero(M, 3 * corners());
    for (Eigen::Index a = 0; a < ends_.cols(); ++a)
      for (int i = 0; i < 3; ++i)
        if (blocks.free(3 * static_cast<int>(a) + i))
          for (int end = 0; end < 2; ++end)
            y.col(3 * of_node_[ends_(end, a)] + i) += 0.5 * x.col(3 * a + i);
    hold(blocks, y);
    return y;
  }

 private:
  template <int M>
  void hold(const NodeBlocks& blocks, Vectors<M>& x) const {
    for (int i = 0; i < corners(); ++i)
      for (int c = 0; c < 3; ++c)
        if (!blocks.free(3 * node_[i] + c)) x.col(3 * i + c).setZero();
  }
  template <class Each>
  void each_child(int corner, Each&& each) const;

  Eigen::Matrix2Xi ends_;
  std::vector<int> node_, of_node_;       ///< of a corner, and back (-1: midside)
  std::vector<int> first_child_, child_;  ///< nodes that a corner is an end of
  std::vector<int> start_, column_;
  std::vector<double> values_;
};

}  // namespace hookeye
