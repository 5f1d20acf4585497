// mooney-rivlin {c10, c01, kappa}
//
// W = c10 (I1bar - 3) + c01 (I2bar - 3) + kappa/2 (J - 1)^2. Rubber up to some 100 % strain; c01
// lowers the stress in tension against that in compression and shear. Small-strain shear modulus
// 2 (c10 + c01), which must be positive; c01 = 0 is neo-Hooke.
#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

using laws::Response;

class MooneyRivlin final : public laws::InvariantLaw {
 public:
  MooneyRivlin(double c10, double c01, double kappa) : c10_(c10), c01_(c01), kappa_(kappa) {}
  std::string name() const override { return "mooney-rivlin"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    const double typical = c10_ + c01_;
    return {laws::coefficient("c10", "first Mooney-Rivlin modulus", units.stress(), c10_, typical),
            laws::coefficient("c01", "second Mooney-Rivlin modulus", units.stress(), c01_, typical),
            laws::modulus("kappa", "bulk modulus", units.stress(), kappa_)};
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& v) const override {
    return mooney_rivlin(v[0], v[1], v[2]);
  }

 protected:
  bool uses_I2() const override { return true; }
  Response response(double I1, double I2, double J) const override {
    Response r;
    r.W = c10_ * (I1 - 3) + c01_ * (I2 - 3);
    r.d1 = c10_;
    r.d2 = c01_;
    laws::add_volumetric(kappa_, J, r);
    return r;
  }
  Response response_dtheta(double, double, double J, int k) const override {
    Response r;
    if (k == 0) r.d1 = 1;
    if (k == 1) r.d2 = 1;
    if (k == 2) laws::add_volumetric(1.0, J, r);
    return r;
  }

 private:
  double c10_, c01_, kappa_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> mooney_rivlin(double c10, double c01, double kappa) {
  return std::make_shared<MooneyRivlin>(c10, c01, kappa);
}

}  // namespace hookeye
