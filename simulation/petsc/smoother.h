// Smoothing on the elements of the body.
#pragma once

#include "simulation/petsc/node_blocks.h"

namespace hookeye {

/// Polynomials of Chebyshev in D^-1 K, D the blocks of single nodes (Saad, Iterative Methods for
/// Sparse Linear Systems, 2003, 12.1). Its values are rounded to float: it reads half as much, and
/// remains one symmetric operator.
class Smoother {
 public:
  /// Keeps a reference.
  explicit Smoother(const NodeBlocks& K) : K_(K) {}
  /// False: K is not positive definite, as a block of D is not or K's curvature is negative.
  bool set_up();
  double bytes() const;

  /// z = S r, and r becomes r - K z.
  template <int M>
  void smooth(Vectors<M>& r, Vectors<M>& z) const;
  /// z += S (r - K z), r = b - K z as it was before.
  template <int M>
  void smooth_again(Vectors<M>& r, Vectors<M>& z) const;
  /// r -= K z.
  template <int M>
  void take_off(const Vectors<M>& z, Vectors<M>& r) const {
    Vectors<M> Kz;
    K_.multiply<float, M>(values_, z, Kz);
    r -= Kz;
  }

 private:
  template <int M>
  Vectors<M> by_nodes(const Vectors<M>& r) const;
  template <int M>
  void polynomial(Vectors<M>& r, Vectors<M>& z, bool residual_after) const;
  bool find_largest();

  const NodeBlocks& K_;
  std::vector<float> values_;
  std::vector<Eigen::Matrix3d> inverse_;  ///< of D's blocks
  double largest_ = 0.0;                  ///< eigenvalue of D^-1 K, with a margin
};

}  // namespace hookeye
