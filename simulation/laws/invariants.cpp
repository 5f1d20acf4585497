#include "simulation/laws/invariants.h"

#include <cmath>
#include <limits>

namespace hookeye::laws {

void add_d2J(double scale, const Matrix3d& F, Matrix9d& D) {
  // d2J/dF_ia dF_jb = e_ijk e_abc F_kc: the block (a, b) is -+ the cross-product matrix of column
  // c.
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const Eigen::Vector3d f = scale * F.col((a + 2) % 3);
    Matrix3d cross;  // rows i, columns j: e_ijk f_k
    cross << 0, f[2], -f[1], -f[2], 0, f[0], f[1], -f[0], 0;
    D.block<3, 3>(3 * a, 3 * b) += cross;
    D.block<3, 3>(3 * b, 3 * a) -= cross;
  }
}

double Isochoric::add_hessian(const Deformation& d, double w, double w2, Matrix9d& D) const {
  const Vector9d c = vec(d.cof), g = vec(dI);
  const double s = w * scale / d.J;
  Vector9d mixed = (-p * s) * g + (0.5 * p * (p + 1) * s * I / d.J) * c;
  D.noalias() += mixed * c.transpose();
  D.noalias() += c * mixed.transpose();
  if (w2 != 0) {
    const Vector9d gbar = scale * (g - (p * I / d.J) * c);
    D.noalias() += (w2 * gbar) * gbar.transpose();
  }
  return -p * s * I;
}

Isochoric i1bar(const Deformation& d) {
  return {2.0 / 3.0, d.F.squaredNorm(), 1.0 / std::cbrt(d.J * d.J), 2.0 * d.F};
}

Isochoric i2bar(const Deformation& d) {
  const double s = 1.0 / std::cbrt(d.J * d.J);
  const Matrix3d C = d.F.transpose() * d.F;
  return {4.0 / 3.0, d.cof.squaredNorm(), s * s, 2.0 * (C.trace() * d.F - d.F * C)};
}

Isochoric i4bar(const Deformation& d, const Eigen::Vector3d& a) {
  const Eigen::Vector3d Fa = d.F * a;
  return {2.0 / 3.0, Fa.squaredNorm(), 1.0 / std::cbrt(d.J * d.J), 2.0 * Fa * a.transpose()};
}

Eigen::Vector3d taken_up(double E, double toe) {
  if (E <= 0) return Eigen::Vector3d::Zero();
  if (E >= toe) return {E * E - toe * toe / 6, 2 * E, 2};
  const double t = E / toe;
  return {toe * toe * t * t * t * (4.0 / 3 - t / 2), toe * t * t * (4 - 2 * t), t * (8 - 6 * t)};
}

void add_d2I1(double scale, Matrix9d& D) { D.diagonal().array() += 2.0 * scale; }

void add_d2I2(double scale, const Matrix3d& F, Matrix9d& D) {
  // dI2 = 2 (tr(C) F - F C), so d2I2 dF = 2 (2 (F:dF) F + tr(C) dF - dF C - F dF^T F - B dF).
  const Matrix3d C = F.transpose() * F;
  const Matrix3d I1_B = C.trace() * Matrix3d::Identity() - F * F.transpose();
  const double s = 2.0 * scale;
  for (int b = 0; b < 3; ++b) {
    for (int a = 0; a < 3; ++a) {
      Matrix3d block = 2.0 * F.col(a) * F.col(b).transpose() - F.col(b) * F.col(a).transpose();
      block.diagonal().array() -= C(a, b);
      if (a == b) block += I1_B;
      D.block<3, 3>(3 * a, 3 * b) += s * block;
    }
  }
}

void add_d2I4(double scale, const Eigen::Vector3d& a, Matrix9d& D) {
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      D.block<3, 3>(3 * i, 3 * j).diagonal().array() += 2.0 * scale * a[i] * a[j];
}

double InvariantLaw::psi(const Matrix3d& F) const {
  const Deformation d(F);
  if (!(d.J > 0)) return std::numeric_limits<double>::infinity();
  return response(i1bar(d).value(), uses_I2() ? i2bar(d).value() : 3.0, d.J).W;
}

Matrix3d InvariantLaw::P(const Matrix3d& F) const {
  const Deformation d(F);
  const Isochoric a = i1bar(d);
  if (!uses_I2()) {
    const Response r = response(a.value(), 3.0, d.J);
    return r.d1 * a.gradient(d) + r.dJ * d.cof;
  }
  const Isochoric b = i2bar(d);
  const Response r = response(a.value(), b.value(), d.J);
  return r.d1 * a.gradient(d) + r.d2 * b.gradient(d) + r.dJ * d.cof;
}

Matrix9d InvariantLaw::dP_dF(const Matrix3d& F) const {
  const Deformation d(F);
  const Isochoric a = i1bar(d);
  Matrix9d D = Matrix9d::Zero();
  Response r;
  double d2J = 0;
  if (uses_I2()) {
    const Isochoric b = i2bar(d);
    r = response(a.value(), b.value(), d.J);
    d2J += b.add_hessian(d, r.d2, r.d22, D);
    add_d2I2(r.d2 * b.scale, F, D);
  } else {
    r = response(a.value(), 3.0, d.J);
  }
  d2J += a.add_hessian(d, r.d1, r.d11, D);
  add_d2I1(r.d1 * a.scale, D);
  const Vector9d c = vec(d.cof);
  D.noalias() += (r.dJJ * c) * c.transpose();
  add_d2J(d2J + r.dJ, F, D);
  return D;
}

Matrix3d InvariantLaw::dP_dtheta(const Matrix3d& F, int k) const {
  const Deformation d(F);
  const Isochoric a = i1bar(d);
  if (!uses_I2()) {
    const Response r = response_dtheta(a.value(), 3.0, d.J, k);
    return r.d1 * a.gradient(d) + r.dJ * d.cof;
  }
  const Isochoric b = i2bar(d);
  const Response r = response_dtheta(a.value(), b.value(), d.J, k);
  return r.d1 * a.gradient(d) + r.d2 * b.gradient(d) + r.dJ * d.cof;
}

Parameter modulus(std::string name, std::string long_name, std::string unit, double value) {
  Parameter p;
  p.name = std::move(name);
  p.long_name = std::move(long_name);
  p.unit = std::move(unit);
  p.value = value;
  p.low = 0.0;
  p.typical = value > 0 ? value : 1.0;
  p.positive = true;
  return p;
}

Parameter coefficient(std::string name, std::string long_name, std::string unit, double value,
                      double typical) {
  Parameter p;
  p.name = std::move(name);
  p.long_name = std::move(long_name);
  p.unit = std::move(unit);
  p.value = value;
  p.typical = typical > 0 ? typical : 1.0;
  return p;
}

}  // namespace hookeye::laws
