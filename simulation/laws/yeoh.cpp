// yeoh {c1, c2, c3, kappa}
//
// W = c1 (I1bar - 3) + c2 (I1bar - 3)^2 + c3 (I1bar - 3)^3 + kappa/2 (J - 1)^2. Rubber that softens
// (c2 < 0) and stiffens again at large strain (c3 > 0). Small-strain shear modulus 2 c1.
#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

using laws::Response;

class Yeoh final : public laws::InvariantLaw {
 public:
  Yeoh(double c1, double c2, double c3, double kappa) : c1_(c1), c2_(c2), c3_(c3), kappa_(kappa) {}
  std::string name() const override { return "yeoh"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    return {laws::modulus("c1", "first Yeoh modulus", units.stress(), c1_),
            laws::coefficient("c2", "second Yeoh modulus", units.stress(), c2_, c1_),
            laws::coefficient("c3", "third Yeoh modulus", units.stress(), c3_, c1_),
            laws::modulus("kappa", "bulk modulus", units.stress(), kappa_)};
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& v) const override {
    return yeoh(v[0], v[1], v[2], v[3]);
  }

 protected:
  Response response(double I1, double, double J) const override {
    const double i = I1 - 3;
    Response r;
    r.W = ((c3_ * i + c2_) * i + c1_) * i;
    r.d1 = (3 * c3_ * i + 2 * c2_) * i + c1_;
    r.d11 = 6 * c3_ * i + 2 * c2_;
    laws::add_volumetric(kappa_, J, r);
    return r;
  }
  Response response_dtheta(double I1, double, double J, int k) const override {
    const double i = I1 - 3;
    Response r;
    if (k == 0) r.d1 = 1;
    if (k == 1) r.d1 = 2 * i;
    if (k == 2) r.d1 = 3 * i * i;
    if (k == 3) laws::add_volumetric(1.0, J, r);
    return r;
  }

 private:
  double c1_, c2_, c3_, kappa_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> yeoh(double c1, double c2, double c3, double kappa) {
  return std::make_shared<Yeoh>(c1, c2, c3, kappa);
}

}  // namespace hookeye
