// stvk {lambda, mu}
//
// St Venant-Kirchhoff: W = lambda/2 tr(E)^2 + mu E:E. Linear in the Green strain E; for large
// rotations and small strains. Loses stability in strong compression (uniaxial stretch below
// 0.577), where the solver stops before an element inverts.
#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

class StVk final : public EnergyTerm {
 public:
  StVk(double lambda, double mu) : lambda_(lambda), mu_(mu) {}
  std::string name() const override { return "stvk"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    // lambda > -2/3 mu is all that stability asks; below 0 nobody has seen a soft material.
    return {laws::modulus("lambda", "first Lame parameter", units.stress(), lambda_),
            laws::modulus("mu", "shear modulus", units.stress(), mu_)};
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& v) const override {
    return stvk(v[0], v[1]);
  }
  double psi(const Matrix3d& F) const override {
    const Matrix3d E = green(F);
    return 0.5 * lambda_ * E.trace() * E.trace() + mu_ * E.squaredNorm();
  }
  Matrix3d P(const Matrix3d& F) const override { return F * second_piola(green(F)); }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    // dP = dF S + F (lambda tr(dE) I + 2 mu dE), 2 dE = dF^T F + F^T dF.
    const Matrix3d S = second_piola(green(F)), B = F * F.transpose();
    Matrix9d D;
    for (int b = 0; b < 3; ++b) {
      for (int a = 0; a < 3; ++a) {
        Matrix3d block =
            lambda_ * F.col(a) * F.col(b).transpose() + mu_ * F.col(b) * F.col(a).transpose();
        if (a == b) block += mu_ * B;
        block.diagonal().array() += S(a, b);
        D.block<3, 3>(3 * a, 3 * b) = block;
      }
    }
    return D;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    const Matrix3d E = green(F);
    if (k == 0) return E.trace() * F;
    return 2.0 * F * E;
  }

 private:
  static Matrix3d green(const Matrix3d& F) {
    return 0.5 * (F.transpose() * F - Matrix3d::Identity());
  }
  Matrix3d second_piola(const Matrix3d& E) const {
    return lambda_ * E.trace() * Matrix3d::Identity() + 2.0 * mu_ * E;
  }
  double lambda_, mu_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> stvk(double lambda, double mu) {
  return std::make_shared<StVk>(lambda, mu);
}

}  // namespace hookeye
