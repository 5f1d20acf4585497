// fibre: an addend for other laws, not a material by itself
//
// W = stiffness/2 (I4bar - 1)^2, I4bar = J^(-2/3) a.C a, along the unit rest direction a; acts in
// tension and compression. For woven or printed material that is stiffer along one direction. The
// direction's three numbers are parameters too; only its direction counts (a is normalised).
#include <limits>

#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

class Fibre final : public EnergyTerm {
 public:
  Fibre(double stiffness, const Eigen::Vector3d& direction)
      : k_(stiffness), d_(direction), a_(direction.normalized()) {}
  std::string name() const override { return "fibre"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    return {laws::modulus("stiffness", "fibre stiffness", units.stress(), k_),
            laws::coefficient("direction.x", "fibre direction, x", "", d_.x(), 1.0),
            laws::coefficient("direction.y", "fibre direction, y", "", d_.y(), 1.0),
            laws::coefficient("direction.z", "fibre direction, z", "", d_.z(), 1.0)};
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& v) const override {
    return fibre(v[0], v.segment<3>(1));
  }
  double psi(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    if (!(d.J > 0)) return std::numeric_limits<double>::infinity();
    const double x = laws::i4bar(d, a_).value() - 1;
    return 0.5 * k_ * x * x;
  }
  Matrix3d P(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    const laws::Isochoric i = laws::i4bar(d, a_);
    return (k_ * (i.value() - 1)) * i.gradient(d);
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    const laws::Deformation d(F);
    const laws::Isochoric i = laws::i4bar(d, a_);
    const double w = k_ * (i.value() - 1);
    Matrix9d D = Matrix9d::Zero();
    const double d2J = i.add_hessian(d, w, k_, D);
    laws::add_d2I4(w * i.scale, a_, D);
    laws::add_d2J(d2J, F, D);
    return D;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    const laws::Deformation d(F);
    const laws::Isochoric i = laws::i4bar(d, a_);
    if (k == 0) return (i.value() - 1) * i.gradient(d);
    // By the direction: a = d/|d|, da = (e - a a.e)/|d|; dI4bar = 2 s a.C da and
    // d(gradient) = s (2 F (da a^T + a da^T) - p dI4/J cof).
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(k - 1);
    const Eigen::Vector3d da = (e - a_ * a_.dot(e)) / d_.norm();
    const double dI4 = 2.0 * (F * a_).dot(F * da);
    const Matrix3d dgradient = i.scale * (2.0 * F * (da * a_.transpose() + a_ * da.transpose()) -
                                          (i.p * dI4 / d.J) * d.cof);
    return k_ * (i.scale * dI4 * i.gradient(d) + (i.value() - 1) * dgradient);
  }

 private:
  double k_;
  Eigen::Vector3d d_, a_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> fibre(double stiffness, const Eigen::Vector3d& direction) {
  return std::make_shared<Fibre>(stiffness, direction);
}

}  // namespace hookeye
