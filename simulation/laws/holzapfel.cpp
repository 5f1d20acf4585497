// holzapfel {mu, k1, k2, angles: [...] or directions: [[x, y, z], ...], kappa; dispersion, toe,
//            frame}
//
// W = mu/2 (I1bar - 3) + kappa/2 (J - 1)^2 + sum over the families of fibres of
//     k1/(2 k2) (exp(k2 u(E)) - 1),  E = d (I1bar - 3) + (1 - 3 d) (I4bar - 1)
// (Gasser, Ogden, Holzapfel 2006; d: dispersion, their kappa). Arteries, tendon, fabric-reinforced
// rubber: a soft matrix, and fibres that carry load in tension only and stiffen exponentially.
// d = 0: all fibres of a family along its direction; d = 1/3: along all directions alike.
// u = E^2 in tension and 0 in compression would let the stiffness jump at rest, where Newton and
// sensitivities break. So fibres take up load over 0 < E < toe, where u is the quartic that joins 0
// to E^2 - toe^2/6 with two derivatives; beyond it the stress is that of u = E^2 but for the factor
// exp(-k2 toe^2/6). At rest fibres are slack: small-strain moduli are mu and kappa.
#include <cmath>
#include <limits>

#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

using laws::Isochoric;
using laws::Vector9d;

const double kDegree = EIGEN_PI / 180.0;

class Holzapfel final : public EnergyTerm {
 public:
  explicit Holzapfel(HolzapfelValues v) : v_(std::move(v)) {
    for (double angle : v_.angles)
      v_.directions.push_back(std::cos(angle * kDegree) * v_.frame.col(0) +
                              std::sin(angle * kDegree) * v_.frame.col(1));
  }
  std::string name() const override { return "holzapfel"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    Parameter dispersion =
        laws::coefficient("dispersion", "dispersion of the fibres", "", v_.dispersion, 0.1);
    dispersion.low = 0.0;
    dispersion.high = 1.0 / 3;
    std::vector<Parameter> all = {laws::modulus("mu", "shear modulus", units.stress(), v_.mu),
                                  laws::modulus("k1", "fibre modulus", units.stress(), v_.k1),
                                  laws::modulus("k2", "fibre exponent", "", v_.k2), dispersion,
                                  laws::modulus("kappa", "bulk modulus", units.stress(), v_.kappa)};
    for (size_t i = 0; i < v_.angles.size(); ++i)
      all.push_back(laws::coefficient("angle" + std::to_string(i + 1), "angle of the fibres",
                                      "degrees", v_.angles[i], 10.0));
    return all;
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& x) const override {
    HolzapfelValues v = v_;
    v.mu = x[0], v.k1 = x[1], v.k2 = x[2], v.dispersion = x[3], v.kappa = x[4];
    if (!v.angles.empty()) v.directions.clear();
    for (size_t i = 0; i < v.angles.size(); ++i) v.angles[i] = x[static_cast<Eigen::Index>(5 + i)];
    return holzapfel(v);
  }
  const CylinderFrame* cylinder() const override { return v_.cylinder ? &*v_.cylinder : nullptr; }

  double psi(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    if (!(d.J > 0)) return std::numeric_limits<double>::infinity();
    const Isochoric i1 = laws::i1bar(d);
    double W = 0.5 * v_.mu * (i1.value() - 3) + 0.5 * v_.kappa * (d.J - 1) * (d.J - 1);
    for (const Eigen::Vector3d& a : v_.directions) {
      const double u = laws::taken_up(Family(*this, d, i1, a).E, v_.toe)[0];
      W += 0.5 * v_.k1 / v_.k2 * std::expm1(v_.k2 * u);
    }
    return W;
  }
  Matrix3d P(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    const Isochoric i1 = laws::i1bar(d);
    Matrix3d P = 0.5 * v_.mu * i1.gradient(d) + v_.kappa * (d.J - 1) * d.cof;
    for (const Eigen::Vector3d& a : v_.directions) {
      const Family f(*this, d, i1, a);
      P += f.w1 * f.dE;
    }
    return P;
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    const Isochoric i1 = laws::i1bar(d);
    Matrix9d D = Matrix9d::Zero();
    double by_i1 = 0.5 * v_.mu, d2J = v_.kappa * (d.J - 1);
    for (const Eigen::Vector3d& a : v_.directions) {
      const Family f(*this, d, i1, a);
      const double by_i4 = f.w1 * (1 - 3 * v_.dispersion);
      by_i1 += f.w1 * v_.dispersion;
      d2J += f.i4.add_hessian(d, by_i4, 0.0, D);
      laws::add_d2I4(by_i4 * f.i4.scale, a, D);
      const Vector9d g = laws::vec(f.dE);
      D.noalias() += (f.w2 * g) * g.transpose();
    }
    d2J += i1.add_hessian(d, by_i1, 0.0, D);
    laws::add_d2I1(by_i1 * i1.scale, D);
    const Vector9d cof = laws::vec(d.cof);
    D.noalias() += (v_.kappa * cof) * cof.transpose();
    laws::add_d2J(d2J, F, D);
    return D;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    const laws::Deformation d(F);
    const Isochoric i1 = laws::i1bar(d);
    if (k == 0) return 0.5 * i1.gradient(d);
    if (k == 4) return (d.J - 1) * d.cof;
    if (k >= 5) return by_angle(d, i1, static_cast<size_t>(k - 5));
    Matrix3d out = Matrix3d::Zero();
    for (const Eigen::Vector3d& a : v_.directions) {
      const Family f(*this, d, i1, a);
      if (k == 1) out += f.w1 / v_.k1 * f.dE;
      if (k == 2) out += f.w1 * laws::taken_up(f.E, v_.toe)[0] * f.dE;
      if (k == 3)
        out += f.w2 * (i1.value() - 3 - 3 * (f.i4.value() - 1)) * f.dE +
               f.w1 * (i1.gradient(d) - 3 * f.i4.gradient(d));
    }
    return out;
  }

 private:
  /// One family at one F: E, its gradient, and the energy's first two derivatives by E.
  struct Family {
    Family(const Holzapfel& law, const laws::Deformation& d, const Isochoric& i1,
           const Eigen::Vector3d& a)
        : i4(laws::i4bar(d, a)) {
      const HolzapfelValues& v = law.v_;
      const double along = 1 - 3 * v.dispersion;
      E = v.dispersion * (i1.value() - 3) + along * (i4.value() - 1);
      dE = v.dispersion * i1.gradient(d) + along * i4.gradient(d);
      const Eigen::Vector3d u = laws::taken_up(E, v.toe);
      const double k = 0.5 * v.k1 * std::exp(v.k2 * u[0]);
      w1 = k * u[1];
      w2 = k * (u[2] + v.k2 * u[1] * u[1]);
    }
    Isochoric i4;
    double E, w1, w2;
    Matrix3d dE;
  };

  /// As in fibre.cpp: dI4bar = 2 s Fa.F da, and the gradient's own change; per degree.
  Matrix3d by_angle(const laws::Deformation& d, const Isochoric& i1, size_t i) const {
    const Eigen::Vector3d& a = v_.directions[i];
    const double angle = v_.angles[i] * kDegree, along = 1 - 3 * v_.dispersion;
    const Eigen::Vector3d da =
        kDegree * (std::cos(angle) * v_.frame.col(1) - std::sin(angle) * v_.frame.col(0));
    const Family f(*this, d, i1, a);
    const double dI4 = 2.0 * (d.F * a).dot(d.F * da);
    const Matrix3d dgradient = f.i4.scale * (2.0 * d.F * (da * a.transpose() + a * da.transpose()) -
                                             (f.i4.p * dI4 / d.J) * d.cof);
    return along * (f.w2 * f.i4.scale * dI4 * f.dE + f.w1 * dgradient);
  }

  HolzapfelValues v_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> holzapfel(const HolzapfelValues& values) {
  return std::make_shared<Holzapfel>(values);
}

}  // namespace hookeye
