// Isochoric invariants of F with first and second derivatives, shared by the laws.
//
// I1bar = J^(-2/3) tr C, I2bar = J^(-4/3) (tr(C)^2 - tr(C^2)) / 2, I4bar = J^(-2/3) a.C a
// (Holzapfel, Nonlinear Solid Mechanics, 6.4). All have the form J^(-p) I.
#pragma once

#include <Eigen/Dense>

#include "simulation/energy_term.h"

namespace hookeye::laws {

using Vector9d = Eigen::Matrix<double, 9, 1>;

inline Vector9d vec(const Matrix3d& A) { return Eigen::Map<const Vector9d>(A.data()); }
inline Matrix3d unvec(const Vector9d& a) { return Eigen::Map<const Matrix3d>(a.data()); }

/// dJ/dF, columns are cross products of the other two columns of F.
inline Matrix3d cofactor(const Matrix3d& F) {
  Matrix3d cof;
  cof.col(0) = F.col(1).cross(F.col(2));
  cof.col(1) = F.col(2).cross(F.col(0));
  cof.col(2) = F.col(0).cross(F.col(1));
  return cof;
}

/// D += scale * d2J/dF2.
void add_d2J(double scale, const Matrix3d& F, Matrix9d& D);

/// What all invariants need of F, computed once.
struct Deformation {
  explicit Deformation(const Matrix3d& F_)
      : F(F_), cof(cofactor(F_)), J(F_.col(0).dot(cof.col(0))) {}
  Matrix3d F, cof;
  double J;
};

/// An isochoric invariant Ibar = J^(-p) I: value, gradient, and the pieces of its Hessian that
/// scale with dW/dIbar.
struct Isochoric {
  double p, I, scale;  ///< scale = J^(-p)
  Matrix3d dI;
  double value() const { return scale * I; }
  Matrix3d gradient(const Deformation& d) const { return scale * (dI - (p * I / d.J) * d.cof); }
  /// D += w d2Ibar/dF2 + w2 dIbar dIbar^T, without the two parts that callers batch: w J^(-p)
  /// d2I/dF2 (depends on the invariant) and d2J (its coefficient is returned).
  double add_hessian(const Deformation& d, double w, double w2, Matrix9d& D) const;
};

Isochoric i1bar(const Deformation& d);
Isochoric i2bar(const Deformation& d);
Isochoric i4bar(const Deformation& d, const Eigen::Vector3d& a);
/// D += scale * d2I/dF2 of the plain invariant.
void add_d2I1(double scale, Matrix9d& D);
void add_d2I2(double scale, const Matrix3d& F, Matrix9d& D);
void add_d2I4(double scale, const Eigen::Vector3d& a, Matrix9d& D);

/// u, u', u'' of fibres that only pull, by E: the quartic that joins 0 to E^2 - toe^2/6 over
/// 0 < E < toe with two derivatives (holzapfel.cpp).
Eigen::Vector3d taken_up(double E, double toe);

/// W = f(I1bar) + g(I2bar) + h(J) with first and second derivatives by each.
struct Response {
  double W = 0;
  double d1 = 0, d11 = 0;  ///< by I1bar
  double d2 = 0, d22 = 0;  ///< by I2bar
  double dJ = 0, dJJ = 0;
};

/// Base of laws that are sums of functions of I1bar, I2bar and J. A law says its response, and the
/// response's derivative by each parameter (W, d1, d2, dJ are read).
class InvariantLaw : public EnergyTerm {
 public:
  double psi(const Matrix3d& F) const final;
  Matrix3d P(const Matrix3d& F) const final;
  Matrix9d dP_dF(const Matrix3d& F) const final;
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const final;

 protected:
  /// I2bar is computed only where this is true (else 3 is passed).
  virtual bool uses_I2() const { return false; }
  virtual Response response(double I1, double I2, double J) const = 0;
  virtual Response response_dtheta(double I1, double I2, double J, int k) const = 0;
};

/// kappa/2 (J - 1)^2 added to a response, and its derivative by kappa.
inline void add_volumetric(double kappa, double J, Response& r) {
  r.W += 0.5 * kappa * (J - 1) * (J - 1);
  r.dJ += kappa * (J - 1);
  r.dJJ += kappa;
}

/// A modulus: strictly positive, fitted as its logarithm.
Parameter modulus(std::string name, std::string long_name, std::string unit, double value);
/// A coefficient of any sign whose natural size is `typical`.
Parameter coefficient(std::string name, std::string long_name, std::string unit, double value,
                      double typical);

}  // namespace hookeye::laws
