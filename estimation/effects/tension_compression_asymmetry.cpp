#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// W = -b y / sqrt(x/3 + e0^2), x = I1bar - 3, y = I2bar - I1bar. Incompressible uniaxial strain e:
/// x = 3 e^2, y = -2 e^3 to leading order, so W = 2 b e^2 sign(e) beyond e0 and of third order
/// below it: the modulus in tension is higher than in compression by a fixed share (bimodular,
/// Ambartsumyan 1965), with a smooth switch of width e0 and an unchanged modulus at rest.
/// In shear y = 0: nothing changes.
class Bimodular final : public EnergyTerm {
 public:
  Bimodular(double b, double e0)
      : b_(b), e0_(e0), first_(mooney_rivlin(1, 0, 0)), second_(mooney_rivlin(0, 1, 0)) {}
  std::string name() const override { return "bimodular"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    Parameter b;
    b.name = "b";
    b.unit = units.stress();
    b.long_name = "tension-compression difference";
    b.value = b_;
    b.typical = std::max(std::abs(b_), 1e-300);
    return {b};
  }
  std::shared_ptr<const EnergyTerm> with(const VectorXd& values) const override {
    return std::make_shared<Bimodular>(values[0], e0_);
  }
  double psi(const Matrix3d& F) const override {
    if (!(F.determinant() > 0.0)) return std::numeric_limits<double>::infinity();
    const double x = first_->psi(F);
    return -b_ * (second_->psi(F) - x) / root(x);
  }
  Matrix3d P(const Matrix3d& F) const override { return b_ * dP_dtheta(F, 0); }
  Matrix3d dP_dtheta(const Matrix3d& F, int) const override {
    const double x = first_->psi(F), y = second_->psi(F) - x, s = root(x);
    const Matrix3d G1 = first_->P(F), Gy = second_->P(F) - G1;
    return -Gy / s + (y / (6.0 * s * s * s)) * G1;
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    using Vector9d = Eigen::Matrix<double, 9, 1>;
    const double x = first_->psi(F), y = second_->psi(F) - x, s = root(x);
    const Matrix3d P1 = first_->P(F), Py = second_->P(F) - P1;
    const Eigen::Map<const Vector9d> g1(P1.data()), gy(Py.data());
    const Matrix9d H1 = first_->dP_dF(F), Hy = second_->dP_dF(F) - H1;
    // With s' = 1/(6 s): d(1/s)/dx = -1/(6 s^3), d(1/s^3)/dx = -1/(2 s^5).
    const double a = 1.0 / (6.0 * s * s * s);
    Matrix9d D = -Hy / s + (y * a) * H1;
    D += a * (gy * g1.transpose() + g1 * gy.transpose());
    D -= (y / (12.0 * std::pow(s, 5))) * g1 * g1.transpose();
    return b_ * D;
  }

 private:
  double root(double x) const { return std::sqrt(std::max(x, 0.0) / 3.0 + e0_ * e0_); }
  double b_, e0_;
  std::shared_ptr<const EnergyTerm> first_, second_;  ///< I1bar - 3, I2bar - 3
};

const double kSwitchStrain = 0.02;

/// W += c [(I2bar - 3) - (I1bar - 3)]: odd in the strain, of third order; shear modulus unchanged.
std::shared_ptr<const EnergyTerm> odd_term(double c) { return mooney_rivlin(-c, c, 0.0); }
std::shared_ptr<const EnergyTerm> bimodular_term(double b) {
  return std::make_shared<Bimodular>(b, kSwitchStrain);
}

/// Strains over which an additive material is tried to begin to differ: a switch at rest, and a
/// growth over what photos show.
const double kTensionReaches[] = {0.02, 0.1, 0.5};

/// The same function of E11, E22 and E33, zero on one side of rest: `values` are its moduli at the
/// control points `at` on the other side, from rest outwards.
AdditiveModel one_sided(const AdditiveModel& base, bool tension, std::vector<double> at,
                        const VectorXd& values) {
  VectorXd moduli(values.size() + 1);
  moduli << 0.0, values;
  at.insert(at.begin(), 0.0);
  if (!tension) {
    for (double& x : at) x = x == 0.0 ? 0.0 : -x;
    std::reverse(at.begin(), at.end());
    moduli.reverseInPlace();
  }
  AdditiveModel out = in_frame_of(base);
  for (const char* normal : {"E11", "E22", "E33"}) add_addend(out, normal, at, {}, moduli);
  return out;
}

class TensionCompressionAsymmetry final : public Effect {
 public:
  std::string name() const override { return "tension_compression_asymmetry"; }
  EffectGroup group() const override { return EffectGroup::material; }
  std::string title() const override { return "tension-compression asymmetry"; }
  std::string manual() const override {
    return "The material answers differently to tension and compression at the same size of "
           "strain: growing with strain (as in Mooney-Rivlin rubber) or by a fixed share "
           "(bimodular: foams, cracked or fibrous material). Easily taken for gravity, swelling "
           "or a wrong load in a single example; a pull and a push of the same size tell.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    if (!additive_base(model))
      return {make(model, "growing with strain", odd_term),
              make(model, "by a fixed share", bimodular_term)};
    Ingredients all;
    for (bool tension : {true, false})
      for (double reach : kTensionReaches) all.push_back(of_additive(model, tension, {reach}));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    if (!starts_with(variant, kAdditive) || !additive_base(model)) return nullptr;
    const auto at = ramp_in(variant);
    if (at.empty()) return nullptr;
    return of_additive(model, starts_with(variant, kTension), at);
  }

  /// The same function with a control point in the middle.
  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge != FormEdge::refit || !starts_with(from.variant(), kAdditive)) return {};
    VectorXd finer = values;
    const auto at = refined_ramp(ramp_in(from.variant()), finer);
    return {{of_additive(model, starts_with(from.variant(), kTension), at), std::move(finer)}};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const double mu = initial_shear_modulus(model.energy);
    if (starts_with(ingredient.variant(), kAdditive))
      return fmt::format("stiffer in {0} than in {1}: at {2} % strain by {3} % along an axis",
                         starts_with(ingredient.variant(), kTension) ? "tension" : "compression",
                         starts_with(ingredient.variant(), kTension) ? "compression" : "tension",
                         figure(100.0 * ramp_in(ingredient.variant()).front()),
                         figure(100.0 * values[0] / (3.0 * mu)));
    if (ingredient.variant() == "by a fixed share") {
      const double share = 8.0 * values[0] / (3.0 * mu);
      // A linear step may promise more than all of it.
      return fmt::format("{} % {} in tension than in compression",
                         figure(100.0 * std::abs(std::max(share, -1.0))),
                         share >= 0 ? "stiffer" : "softer");
    }
    // dW = -2 c e^3 uniaxially: secant stress -6 c e^2 against 3 mu e, at e = +-0.1
    const double share = -2.0 * 2.0 * values[0] * 0.1 / mu;
    return fmt::format("at 10 % strain {} % {} in tension than in compression (c01 {} {})",
                       figure(100.0 * std::abs(share)), share >= 0 ? "stiffer" : "softer",
                       figure(values[0]), model.scene->capture.units.stress());
  }

 private:
  static constexpr const char* kAdditive = "additive in";
  static constexpr const char* kTension = "additive in tension";

  std::shared_ptr<const Ingredient> of_additive(const Model& model, bool tension,
                                                const std::vector<double>& at) const {
    const double mu = initial_shear_modulus(model.energy);
    FunctionSpec spec;
    spec.name = name();
    spec.variant = fmt::format("{} at", tension ? kTension : "additive in compression");
    for (size_t i = 0; i < at.size(); ++i) {
      spec.variant += fmt::format(" {:g}", at[i]);
      // A negative modulus on one side alone is not convex: then the other side is the stiffer one.
      spec.parameters.push_back(
          {fmt::format("tension_compression_asymmetry.k{}", i + 1),
           model.scene->capture.units.stress(),
           fmt::format("modulus added at a normal strain of {}{:g}", tension ? "" : "-", at[i]),
           0.0, 0.0, std::numeric_limits<double>::infinity(), 0.5 * mu, false});
    }
    spec.functions = [base = in_frame_of(*additive_base(model)), tension,
                      at](const VectorXd& values) { return one_sided(base, tension, at, values); };
    return additive_function(std::move(spec));
  }

  using Term = std::shared_ptr<const EnergyTerm> (*)(double);
  std::shared_ptr<const Ingredient> make(const Model& model, const std::string& variant,
                                         Term term) const {
    const double mu = initial_shear_modulus(model.energy);
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    const bool odd = term == odd_term;
    spec.parameters = {
        {odd ? "tension_compression_asymmetry.c01" : "tension_compression_asymmetry.b",
         model.scene->capture.units.stress(),
         odd ? "Mooney-Rivlin modulus c01 taken from c10" : "tension-compression difference", 0.0,
         -0.6 * mu, 0.6 * mu, 0.25 * mu, false}};
    spec.touches = {.energy = true};
    spec.apply = [term](const VectorXd& values, Model& m) { add_part(m.energy, term(values[0])); };
    spec.derivative = [term](const VectorXd& values, const Model& m, int example,
                             const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
      if (values[0] != 0.0) return false;
      out.dR_dt = part_force(m, example, equilibrium.q, term(1.0));
      return true;
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(tension_compression_asymmetry, TensionCompressionAsymmetry)
