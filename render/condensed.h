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
  double r2 = 0;        ///< sum of weighted squared residuals: the caller's
  size_t count = 0;     ///< pixels that count
};

/// The photo's sums by vertices, before parameters are known: of residuals r_i (over noise and
/// times the root of the robust weight) that depend on the picture by w_i = dr_i/dI_i.
class NodeNormalEquations {
 public:
  /// Per active pixel of `dI` (as for_each_pixel counts them): `wr`, the derivative of the sum of
  /// r^2/2 by the picture there (w r, where no other pixel's residual depends on it); `w`; and
  /// `Bt_r`, B^T(wr): blurred (wr where there is no blur). `columns.photo` needs
  /// RenderOptions::photo_derivative.
  static NodeNormalEquations accumulate(const SurfaceMesh& surface, const ImageDerivative& dI,
                                        const VectorXd& wr, const VectorXd& w, const VectorXd& Bt_r,
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
