#include <fmt/format.h>

#include <algorithm>

#include "estimation/effects/toolbox.h"
#include "simulation/additive.h"

namespace hookeye {

namespace {

/// Small-strain moduli from the law's tangent at F = I: P_xx by F_xx = lambda + 2 mu, P_xy by
/// F_xy = mu.
struct Moduli {
  double mu, kappa;
};

Moduli initial_moduli(const EnergyTerm& term) {
  const Matrix9d D = term.dP_dF(Eigen::Matrix3d::Identity());
  const double mu = D(3, 3);
  return {mu, D(0, 0) - 4.0 / 3.0 * mu};
}

double poisson(double ratio) { return (3.0 * ratio - 2.0) / (6.0 * ratio + 2.0); }
double ratio_of(double nu) { return 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)); }

/// How the volumetric part of one material may move.
struct Volumetric {
  /// addend: all control values of the additive law's J addend by a common factor.
  enum class Kind { ratio, kappa, lambda, addend } kind = Kind::ratio;
  int part = 0, index = 0;  ///< index of kappa or lambda in the term's parameters
  double value = 0.0;       ///< present kappa_over_mu, kappa or lambda; addend: factor
  double modulus = 0.0;     ///< addend: its tangent modulus at rest
  std::string label;        ///< region of the material, or ""
};

/// A function of J alone.
bool is_volumetric(const AdditiveModel& model, const Addend& a) {
  return a.second < 0 && !a.fixed &&
         model.components[a.first].kind == StrainComponent::Kind::volume;
}

/// The J addend at rest, where it is there and the capture does not fit it.
double free_volume_modulus(const EnergyTerm& term, const MaterialSpec& spec,
                           const Capture& capture) {
  const AdditiveModel& model = *additive_model(term);
  const Addend* J = nullptr;
  for (const Addend& a : model.addends)
    if (is_volumetric(model, a)) J = &a;
  const bool told = spec.law == "additive";
  const bool fitted = std::any_of(capture.fit.begin(), capture.fit.end(), [&](std::string name) {
    if (!spec.region.empty() && starts_with(name, spec.region + "."))
      name.erase(0, spec.region.size() + 1);
    return name == "additive" || name == "J" || starts_with(name, "J.");
  });
  // A material that was told otherwise became additive by a fit, which moves all of it.
  if (!J || !told || fitted) return 0.0;
  return addend_curve(model, static_cast<int>(J - model.addends.data()), 0.0)[2];
}

/// The term with another bulk to shear ratio.
std::shared_ptr<const EnergyTerm> with_value(const EnergyTerm& term, const Volumetric& how,
                                             double value, const Units& units) {
  if (how.kind == Volumetric::Kind::addend) {
    AdditiveModel model = *additive_model(term);
    for (Addend& a : model.addends)
      if (is_volumetric(model, a)) a.stiffness *= value;
    return additive(model);
  }
  const auto declared = term.parameters(units);
  if (how.kind == Volumetric::Kind::ratio) return neo_hookean_tied(declared[0].value, value);
  VectorXd theta(declared.size());
  for (size_t i = 0; i < declared.size(); ++i) theta[i] = declared[i].value;
  theta[how.index] = value;
  return term.with(theta);
}

double value_of_ratio(const EnergyTerm& term, const Volumetric& how, double ratio) {
  const double mu = initial_moduli(term).mu;
  if (how.kind == Volumetric::Kind::ratio) return ratio;
  if (how.kind == Volumetric::Kind::addend) {
    // The other addends resist a change of volume too; only the rest is J's.
    const double others = initial_moduli(term).kappa - how.modulus;
    return std::max(1e-6, (ratio * mu - others) / how.modulus);
  }
  return how.kind == Volumetric::Kind::kappa ? ratio * mu : (ratio - 2.0 / 3.0) * mu;
}

std::vector<Volumetric> free_volumetric(const Model& model) {
  const Capture& capture = model.scene->capture;
  std::vector<Volumetric> out;
  for (size_t part = 0; part < capture.materials.size(); ++part) {
    const MaterialSpec& spec = capture.materials[part];
    const EnergyTerm& term = *model.energy.parts[part].term;
    Volumetric how;
    how.part = static_cast<int>(part);
    how.label = spec.region;
    if (additive_model(term)) {
      how.kind = Volumetric::Kind::addend;
      how.modulus = free_volume_modulus(term, spec, capture);
      how.value = 1.0;
      if (how.modulus > 0) out.push_back(how);
      continue;
    }
    if (spec.parameters.count("kappa_over_mu")) {
      const Moduli now = initial_moduli(term);
      const double told = spec.parameters.at("kappa_over_mu").numbers.at(0);
      // what was told, unless this effect has changed it already
      how.value = std::abs(now.kappa / now.mu - told) < 1e-9 * told ? told : now.kappa / now.mu;
      out.push_back(how);
      continue;
    }
    const auto declared = term.parameters(capture.units);
    for (size_t k = 0; k < declared.size(); ++k) {
      if (declared[k].name != "kappa" && declared[k].name != "lambda") continue;
      const std::string qualified =
          spec.region.empty() ? declared[k].name : spec.region + "." + declared[k].name;
      const auto fitted = [&](const std::string& n) {
        return std::find(capture.fit.begin(), capture.fit.end(), n) != capture.fit.end();
      };
      if (fitted(qualified) || fitted(declared[k].name)) continue;
      how.kind = declared[k].name == "kappa" ? Volumetric::Kind::kappa : Volumetric::Kind::lambda;
      how.index = static_cast<int>(k);
      how.value = declared[k].value;
      out.push_back(how);
    }
  }
  return out;
}

/// Frees the resistance to change of volume. Scored by Poisson's ratio, in which displacements
/// are nearly linear; refitted by what the law is written in.
class Compressibility final : public Effect {
 public:
  std::string name() const override { return "compressibility"; }
  EffectGroup group() const override { return EffectGroup::material; }
  std::string title() const override { return "compressibility"; }
  std::string manual() const override {
    return "The material changes its volume more or less easily than the told bulk modulus says. "
           "Easily taken for swelling or for a strain-dependent modulus; it shows in how much a "
           "stretched body narrows, so views of the sides tell.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const auto free = free_volumetric(model);
    if (free.empty()) {
      if (why_not) *why_not = "the bulk modulus is fitted already, or the law has none";
      return {};
    }
    return {poisson_form(model, free)};
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    const auto free = free_volumetric(model);
    return variant == "bulk modulus" && !free.empty() ? modulus_form(model, free) : nullptr;
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    const auto free = free_volumetric(model);
    if (edge != FormEdge::refit || from.variant() == "bulk modulus" ||
        values.size() != static_cast<int>(free.size()))
      return {};
    VectorXd start(values.size());
    for (size_t i = 0; i < free.size(); ++i) {
      const EnergyTerm& term = *model.energy.parts[free[i].part].term;
      // a linear prediction may overshoot what is possible
      const double ratio = ratio_of(std::clamp(values[i], 0.05, 0.495));
      start[i] = std::max(value_of_ratio(term, free[i], ratio), 1e-6 * initial_moduli(term).mu);
    }
    return {{modulus_form(model, free), std::move(start)}};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const auto free = free_volumetric(model);
    double nu = values[0];
    if (ingredient.variant() == "bulk modulus" && !free.empty()) {
      const double mu = initial_moduli(*model.energy.parts[free[0].part].term).mu;
      double ratio = values[0];
      if (free[0].kind == Volumetric::Kind::kappa) ratio = values[0] / mu;
      if (free[0].kind == Volumetric::Kind::lambda) ratio = values[0] / mu + 2.0 / 3.0;
      if (free[0].kind == Volumetric::Kind::addend) {
        const double now = initial_moduli(*model.energy.parts[free[0].part].term).kappa;
        ratio = (now + (values[0] - 1.0) * free[0].modulus) / mu;
      }
      nu = poisson(ratio);
    }
    return fmt::format("Poisson's ratio is {:.3f} (bulk modulus {} times the shear modulus)", nu,
                       figure(ratio_of(std::min(nu, 0.4999))));
  }

 private:
  static std::string label(const Volumetric& how, const std::string& what) {
    return how.label.empty() ? "compressibility." + what
                             : fmt::format("compressibility.{}.{}", how.label, what);
  }

  std::shared_ptr<const Ingredient> poisson_form(const Model& model,
                                                 const std::vector<Volumetric>& free) const {
    IngredientSpec spec;
    spec.name = name();
    spec.touches = {.energy = true};
    VectorXd start(free.size());
    for (size_t i = 0; i < free.size(); ++i) {
      const Moduli now = initial_moduli(*model.energy.parts[free[i].part].term);
      const double ratio =
          free[i].kind == Volumetric::Kind::ratio ? free[i].value : now.kappa / now.mu;
      start[i] = poisson(ratio);
      spec.parameters.push_back(
          {label(free[i], "poisson"), "", "Poisson's ratio", start[i], -0.9, 0.4995, 0.05, false});
    }
    spec.apply = [free, start](const VectorXd& values, Model& m) {
      for (size_t i = 0; i < free.size(); ++i) {
        if (values[i] == start[i]) continue;
        auto& term = m.energy.parts[free[i].part].term;
        const double value = value_of_ratio(*term, free[i], ratio_of(values[i]));
        term = with_value(*term, free[i], value, m.scene->capture.units);
      }
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> modulus_form(const Model& model,
                                                 const std::vector<Volumetric>& free) const {
    const std::string stress = model.scene->capture.units.stress();
    IngredientSpec spec;
    spec.name = name();
    spec.variant = "bulk modulus";
    spec.touches = {.energy = true};
    for (const Volumetric& how : free) {
      const bool ratio = how.kind == Volumetric::Kind::ratio;
      const bool kappa = how.kind == Volumetric::Kind::kappa;
      const bool addend = how.kind == Volumetric::Kind::addend;
      Parameter parameter;
      parameter.name = label(how, ratio    ? "kappa_over_mu"
                                  : kappa  ? "kappa"
                                  : addend ? "J_factor"
                                           : "lambda");
      parameter.unit = ratio || addend ? "" : stress;
      parameter.long_name = ratio    ? "bulk over shear modulus"
                            : kappa  ? "bulk modulus"
                            : addend ? "factor on the J addend"
                                     : "first Lame modulus";
      parameter.value = how.value;
      parameter.low = 0.0;
      parameter.typical = std::abs(how.value) > 0.0 ? std::abs(how.value) : 1.0;
      parameter.positive = true;
      spec.parameters.push_back(std::move(parameter));
    }
    spec.apply = [free](const VectorXd& values, Model& m) {
      for (size_t i = 0; i < free.size(); ++i) {
        auto& term = m.energy.parts[free[i].part].term;
        term = with_value(*term, free[i], values[i], m.scene->capture.units);
      }
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(compressibility, Compressibility)
