// pulling fibre: an addend for other laws, not a material by itself
//
// W = k1/(2 k2) (exp(k2 u(E)) - 1), E = J^(-2/3) a.C a - 1 or, with the volume counted, a.C a - 1
// (Holzapfel, Gasser, Ogden 2000). Fibres along the unit rest direction a that carry load in
// tension only and stiffen exponentially; k2 = 0 is W = k1/2 u(E). u is E^2 in tension, 0 in
// compression, joined over a toe as in holzapfel.cpp, so that stress and stiffness are continuous.
#include <limits>

#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

class PullingFibre final : public EnergyTerm {
 public:
  explicit PullingFibre(const PullingFibreValues& values) : v_(values) { v_.direction.normalize(); }
  std::string name() const override { return "pulling fibre"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    return {laws::modulus("k1", "fibre modulus", units.stress(), v_.k1),
            laws::coefficient("k2", "fibre exponent", "", v_.k2, 1.0)};
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& x) const override {
    PullingFibreValues v = v_;
    v.k1 = x[0], v.k2 = x[1];
    return pulling_fibre(v);
  }
  double psi(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    if (!(d.J > 0)) return std::numeric_limits<double>::infinity();
    const double u = laws::taken_up(stretch(d).value() - 1, v_.toe)[0];
    return 0.5 * v_.k1 * (v_.k2 == 0.0 ? u : std::expm1(v_.k2 * u) / v_.k2);
  }
  Matrix3d P(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    const laws::Isochoric i4 = stretch(d);
    return slopes(i4)[0] * i4.gradient(d);
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    const laws::Isochoric i4 = stretch(d);
    const Eigen::Vector2d w = slopes(i4);
    Matrix9d D = Matrix9d::Zero();
    const double d2J = i4.add_hessian(d, w[0], w[1], D);
    laws::add_d2I4(w[0] * i4.scale, v_.direction, D);
    laws::add_d2J(d2J, F, D);
    return D;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    const laws::Deformation d(F);
    const laws::Isochoric i4 = stretch(d);
    const double by = k == 0 ? 1.0 / v_.k1 : laws::taken_up(i4.value() - 1, v_.toe)[0];
    return by * slopes(i4)[0] * i4.gradient(d);
  }

 private:
  laws::Isochoric stretch(const laws::Deformation& d) const {
    laws::Isochoric i4 = laws::i4bar(d, v_.direction);
    if (v_.volume_counts) i4.p = 0.0, i4.scale = 1.0;
    return i4;
  }
  /// dW/dE, d2W/dE2.
  Eigen::Vector2d slopes(const laws::Isochoric& i4) const {
    const Eigen::Vector3d u = laws::taken_up(i4.value() - 1, v_.toe);
    return 0.5 * v_.k1 * std::exp(v_.k2 * u[0]) * Eigen::Vector2d(u[1], u[2] + v_.k2 * u[1] * u[1]);
  }

  PullingFibreValues v_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> pulling_fibre(const PullingFibreValues& values) {
  return std::make_shared<PullingFibre>(values);
}

}  // namespace hookeye
