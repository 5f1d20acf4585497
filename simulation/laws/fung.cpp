// fung {c, b: [b11, b22, b33, b12, b23, b13, g12, g23, g13], kappa}
//
// W = c/2 (exp(Q) - 1) + kappa/2 (J - 1)^2, Q = sum b_ij Eii Ejj + 2 sum g_ij Eij^2 (b_ij = b_ji;
// Fung, Fronek, Patitucci 1979). Skin, vessels and other soft tissue that is limp at first and
// locks up: stiffness grows with the exponential of the strain. Axes: those of the rest
// coordinates. The matrix of b must be positive definite and the g positive; then W - kappa/2 (J -
// 1)^2 is convex in E.
#include <cmath>
#include <limits>

#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

using laws::Vector9d;

class Fung final : public EnergyTerm {
 public:
  Fung(double c, const Vector9d& b, double kappa) : c_(c), b_(b), kappa_(kappa) {}
  std::string name() const override { return "fung"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    static const char* names[9] = {"b11", "b22", "b33", "b12", "b23", "b13", "g12", "g23", "g13"};
    std::vector<Parameter> all = {laws::modulus("c", "Fung's modulus", units.stress(), c_)};
    for (int i = 0; i < 9; ++i) {
      all.push_back(laws::coefficient(names[i], "exponent's coefficient", "", b_[i],
                                      b_.cwiseAbs().maxCoeff()));
      if (i < 3 || i > 5) all.back() = laws::modulus(names[i], "exponent's coefficient", "", b_[i]);
    }
    all.push_back(laws::modulus("kappa", "bulk modulus", units.stress(), kappa_));
    return all;
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& v) const override {
    return fung(v[0], v.segment<9>(1), v[10]);
  }
  double psi(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    if (!(d.J > 0)) return std::numeric_limits<double>::infinity();
    const Matrix3d E = green(F);
    return 0.5 * c_ * std::expm1(exponent(b_, E)) + 0.5 * kappa_ * (d.J - 1) * (d.J - 1);
  }
  Matrix3d P(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    const Matrix3d E = green(F);
    return 0.5 * c_ * std::exp(exponent(b_, E)) * F * slope(b_, E) + kappa_ * (d.J - 1) * d.cof;
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    // P = w F Q', w = c/2 exp(Q): dP = w (dF Q' + F Q'' dE) + w (Q' : dE) F Q'.
    const laws::Deformation d(F);
    const Matrix3d E = green(F), Q1 = slope(b_, E), FQ1 = F * Q1;
    const double w = 0.5 * c_ * std::exp(exponent(b_, E));
    Matrix9d D;
    for (int k = 0; k < 9; ++k) {
      Matrix3d dF = Matrix3d::Zero();
      dF(k % 3, k / 3) = 1.0;
      const Matrix3d FtdF = F.transpose() * dF, dE = 0.5 * (FtdF + FtdF.transpose());
      const Matrix3d dP = w * (dF * Q1 + F * slope(b_, dE) + Q1.cwiseProduct(dE).sum() * FQ1);
      D.col(k) = laws::vec(dP);
    }
    const Vector9d cof = laws::vec(d.cof);
    D.noalias() += (kappa_ * cof) * cof.transpose();
    laws::add_d2J(kappa_ * (d.J - 1), F, D);
    return D;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    const laws::Deformation d(F);
    const Matrix3d E = green(F);
    const double exp = std::exp(exponent(b_, E));
    if (k == 0) return 0.5 * exp * F * slope(b_, E);
    if (k == 10) return (d.J - 1) * d.cof;
    const Vector9d e = Vector9d::Unit(k - 1);
    return 0.5 * c_ * exp * F * (slope(e, E) + exponent(e, E) * slope(b_, E));
  }

 private:
  static Matrix3d green(const Matrix3d& F) {
    return 0.5 * (F.transpose() * F - Matrix3d::Identity());
  }
  /// Q and dQ/dE; both linear in b.
  static double exponent(const Vector9d& b, const Matrix3d& E) {
    return 0.5 * slope(b, E).cwiseProduct(E).sum();
  }
  static Matrix3d slope(const Vector9d& b, const Matrix3d& E) {
    Matrix3d S;
    S(0, 0) = 2 * (b[0] * E(0, 0) + b[3] * E(1, 1) + b[5] * E(2, 2));
    S(1, 1) = 2 * (b[3] * E(0, 0) + b[1] * E(1, 1) + b[4] * E(2, 2));
    S(2, 2) = 2 * (b[5] * E(0, 0) + b[4] * E(1, 1) + b[2] * E(2, 2));
    S(0, 1) = S(1, 0) = 2 * b[6] * E(0, 1);
    S(1, 2) = S(2, 1) = 2 * b[7] * E(1, 2);
    S(0, 2) = S(2, 0) = 2 * b[8] * E(0, 2);
    return S;
  }
  double c_;
  Vector9d b_;
  double kappa_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> fung(double c, const Eigen::Matrix<double, 9, 1>& b,
                                       double kappa) {
  return std::make_shared<Fung>(c, b, kappa);
}

}  // namespace hookeye
