// neo-hookean {mu, kappa} or {mu, kappa_over_mu}
//
// W = mu/2 (I1bar - 3) + kappa/2 (J - 1)^2. The first choice for soft rubber and gel below some
// 30 % strain: one stiffness, one compressibility. mu: small-strain shear modulus; kappa: bulk
// modulus, mu (12 to 100) where the material hardly changes volume. With `kappa_over_mu` the ratio
// is kept and mu is the only parameter: pictures of one load tell the two apart poorly.
#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

using laws::Response;

class NeoHookean final : public laws::InvariantLaw {
 public:
  NeoHookean(double mu, double kappa) : mu_(mu), kappa_(kappa) {}
  std::string name() const override { return "neo-hookean"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    return {laws::modulus("mu", "shear modulus", units.stress(), mu_),
            laws::modulus("kappa", "bulk modulus", units.stress(), kappa_)};
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& values) const override {
    return neo_hookean(values[0], values[1]);
  }

 protected:
  Response response(double I1, double, double J) const override {
    Response r;
    r.W = 0.5 * mu_ * (I1 - 3);
    r.d1 = 0.5 * mu_;
    laws::add_volumetric(kappa_, J, r);
    return r;
  }
  Response response_dtheta(double, double, double J, int k) const override {
    Response r;
    if (k == 0) r.d1 = 0.5;
    if (k == 1) laws::add_volumetric(1.0, J, r);
    return r;
  }

 private:
  double mu_, kappa_;
};

class TiedNeoHookean final : public laws::InvariantLaw {
 public:
  TiedNeoHookean(double mu, double ratio) : mu_(mu), ratio_(ratio) {}
  std::string name() const override { return "neo-hookean"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    return {laws::modulus("mu", "shear modulus", units.stress(), mu_)};
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& values) const override {
    return neo_hookean_tied(values[0], ratio_);
  }

 protected:
  Response response(double I1, double, double J) const override {
    Response r;
    r.W = 0.5 * mu_ * (I1 - 3);
    r.d1 = 0.5 * mu_;
    laws::add_volumetric(ratio_ * mu_, J, r);
    return r;
  }
  Response response_dtheta(double, double, double J, int) const override {
    Response r;
    r.d1 = 0.5;
    laws::add_volumetric(ratio_, J, r);
    return r;
  }

 private:
  double mu_, ratio_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> neo_hookean(double mu, double kappa) {
  return std::make_shared<NeoHookean>(mu, kappa);
}
std::shared_ptr<const EnergyTerm> neo_hookean_tied(double mu, double kappa_over_mu) {
  return std::make_shared<TiedNeoHookean>(mu, kappa_over_mu);
}

}  // namespace hookeye
