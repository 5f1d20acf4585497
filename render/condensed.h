// Pixels condensed on the fly: M = sum g^T g and b = sum g^T r (method.md, Fit), so that
// J^T J = S^T M S and J^T r = S^T b for any number of parameters.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "render/renderer.h"

namespace hookeye {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Sensitivity of the vertices of one example's surface by the parameters: d(position) and, as
/// DerivativeSegment::d_second(), d(normal) or d(reference), each 3nv x m (the second may be
/// empty), and d(photo numbers): kPhotoColumns x m.
struct VertexSensitivity {
  RowMatrix position, second;
  Eigen::MatrixXd photo;
};

/// What of a VertexSensitivity is not zero.
struct CondensedColumns {
  bool second = true, photo = true;
};

/// Pixels without a row in the image derivative, where the level behind the body is all that is
/// seen (but for what blur spreads there): sums of their B^T(w r) and, of those that count, of w^2.
struct SumsBehind {
  double Bt_r = 0, ww = 0;
};

/// Normal equations of one photo.
struct CondensedPhoto {
  Eigen::MatrixXd JtJ;  ///< m x m
  Eigen::VectorXd Jtr;  ///< m
  double r2 = 0;        ///< sum of weighted squared residuals
  size_t count = 0;     ///< pixels that count
};

/// The photo's sums by vertices, before parameters are known. Weighted: residual r_i (already over
/// noise and times sqrt of the robust weight), w_i the factor dr_i/dI_i.
class NodeNormalEquations {
 public:
  /// `r` and `w` per active pixel of `dI` (as for_each_pixel counts them). `Bt_r`: per active
  /// pixel, B^T(w r): the blurred adjoint (equal to w*r where there is no blur). `second`:
  /// VertexSensitivity has it. `columns.photo` needs RenderOptions::photo_derivative.
  static NodeNormalEquations accumulate(const SurfaceMesh& surface, const ImageDerivative& dI,
                                        const VectorXd& r, const VectorXd& w, const VectorXd& Bt_r,
                                        CondensedColumns columns, SumsBehind behind = {});
  CondensedPhoto reduce(const VertexSensitivity& S) const;
  NodeNormalEquations();
  ~NodeNormalEquations();
  NodeNormalEquations(NodeNormalEquations&&) noexcept;
  NodeNormalEquations& operator=(NodeNormalEquations&&) noexcept;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
