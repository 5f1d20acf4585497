// An energy that is asked for many points at once.
#pragma once

#include "simulation/energy_term.h"

namespace hookeye {

using Matrix9Xd = Eigen::Matrix<double, 9, Eigen::Dynamic>;

/// A law of which a call costs more than a point: one written in another language. The assembly
/// asks it for a block of elements at a time. It has no parameters of its own; is called from
/// several threads.
class BatchTerm : public EnergyTerm, public std::enable_shared_from_this<BatchTerm> {
 public:
  /// Column k of F: vec of the deformation gradient at point k. Column k of what is returned: psi
  /// (one row), vec P (9 rows), vec dP/dF (81 rows) there.
  virtual Eigen::RowVectorXd psi_of(const Matrix9Xd& F) const = 0;
  virtual Matrix9Xd P_of(const Matrix9Xd& F) const = 0;
  virtual Eigen::MatrixXd dP_dF_of(const Matrix9Xd& F) const = 0;

  std::vector<Parameter> parameters(const Units&) const final { return {}; }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd&) const final {
    return shared_from_this();
  }
  double psi(const Matrix3d& F) const final { return psi_of(F.reshaped())[0]; }
  Matrix3d P(const Matrix3d& F) const final { return P_of(F.reshaped()).reshaped(3, 3); }
  Matrix9d dP_dF(const Matrix3d& F) const final { return dP_dF_of(F.reshaped()).reshaped(9, 9); }
  Matrix3d dP_dtheta(const Matrix3d&, int) const final { return Matrix3d::Zero(); }
  int size() const final { return 0; }
};

}  // namespace hookeye
