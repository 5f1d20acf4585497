#include "estimation/effects/fibre_forms.h"

#include <fmt/format.h>

#include "estimation/effects/own_directions.h"

namespace hookeye {

namespace {

const char* const kPullingAlong = "pulling along";
const char* const kPulling = "free pulling around";
const char* const kPullingVolume = "free pulling, volume counted, around";

std::vector<NextForm> after_fibre(const Model& model, const Vector3d& a, double k) {
  std::vector<NextForm> all;
  if (k > 0.0) {
    const Eigen::Vector4d pulling(k, 0.0, 0.0, 0.0);
    all.push_back({pulling_around(model, a, false), pulling});
    all.push_back({pulling_around(model, a, true), pulling});
  }
  for (auto& form : stiffnesses_after_fibre(model, a, k)) all.push_back(std::move(form));
  return all;
}

}  // namespace

std::shared_ptr<const Ingredient> pulling_along(const Model& model, const Vector3d& a) {
  const auto term = [a](double k) {
    PullingFibreValues values;
    values.k1 = k, values.direction = a;
    return pulling_fibre(values);
  };
  IngredientSpec spec;
  spec.name = "anisotropy";
  spec.variant = fmt::format("{} {}", kPullingAlong, direction_text(a));
  spec.parameters = {modulus_of(model, "k", "fibre modulus", 0.0)};
  spec.touches = {.energy = true};
  spec.apply = [term](const VectorXd& v, Model& m) {
    if (v[0] != 0.0) add_part(m.energy, term(v[0]));
  };
  spec.derivative = [term](const VectorXd& v, const Model& m, int example,
                           const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
    if (v[0] != 0.0) return false;
    out.dR_dt = part_force(m, example, equilibrium.q, term(1.0));
    return true;
  };
  return make_ingredient(std::move(spec));
}

std::vector<NextForm> refit_of_pulling(const Model& model, const Ingredient& scored,
                                       const VectorXd& values) {
  if (!starts_with(scored.variant(), kPullingAlong)) return {};
  return {{pulling_around(model, rounded(base_axis(scored), 1.0), false),
           Eigen::Vector4d(values[0], 0.0, 0.0, 0.0)}};
}

std::shared_ptr<const Ingredient> pulling_around(const Model& model, const Vector3d& a,
                                                 bool volume_counts) {
  IngredientSpec spec;
  spec.name = "anisotropy";
  spec.variant = fmt::format("{} {}", volume_counts ? kPullingVolume : kPulling, vector_text(a, 3));
  spec.parameters = {modulus_of(model, "k", "fibre modulus", 0.0)};
  // exp(k2 E^2) at a stretch of two, E = 3, is beyond any solver from 50 on
  spec.parameters.push_back({"anisotropy.k2", "", "fibre exponent", 0.0, 0.0, 1e3, 1.0, false});
  for (const Parameter& angle : fibre_angles()) spec.parameters.push_back(angle);
  spec.touches = {.energy = true};
  spec.apply = [a, volume_counts](const VectorXd& v, Model& m) {
    if (v[0] == 0.0) return;
    PullingFibreValues values;
    values.k1 = v[0], values.k2 = v[1];
    values.direction = turned(a, v[2], v[3]);
    values.volume_counts = volume_counts;
    add_part(m.energy, pulling_fibre(values));
  };
  return make_ingredient(std::move(spec));
}

std::shared_ptr<const Ingredient> fibre_form(const Model& model, const std::string& variant) {
  if (auto form = stiffness_form(model, variant)) return form;
  const auto n = numbers_in(variant);
  if (n.size() != 3) return nullptr;
  const Vector3d a(n[0], n[1], n[2]);
  if (starts_with(variant, kPullingAlong)) return pulling_along(model, a);
  if (starts_with(variant, kPulling) || starts_with(variant, kPullingVolume))
    return pulling_around(model, a, starts_with(variant, kPullingVolume));
  return nullptr;
}

std::vector<NextForm> further_fibres(const Model& model, const Ingredient& refitted,
                                     const VectorXd& values) {
  if (additive_base(model)) return {};
  if (starts_with(refitted.variant(), "free around"))
    return after_fibre(model, rounded(turned(base_axis(refitted), values[1], values[2]), 1.0),
                       values[0]);
  if (!starts_with(refitted.variant(), kPulling))
    return further_stiffnesses(model, refitted, values);
  const Vector3d a = rounded(base_axis(refitted), 1.0);
  std::vector<NextForm> all = {{pulling_around(model, a, true), values}};
  for (auto& form : stiffnesses_after_fibre(model, a, values[0])) all.push_back(std::move(form));
  return all;
}

std::string fibre_sentence(const Model& model, const Ingredient& ingredient,
                           const VectorXd& values) {
  const std::string variant = ingredient.variant();
  if (variant.find("pulling") == std::string::npos)
    return stiffness_sentence(model, ingredient, values);
  const bool free = values.size() == 4;
  Vector3d a = base_axis(ingredient);
  if (free) a = turned(a, values[2], values[3]);
  if (a.z() < 0.0) a = -a;
  // as a fibre's: 4 k1 against 3 mu, once it pulls
  const double change = 4.0 * values[0] / (3.0 * initial_shear_modulus(model.energy));
  return fmt::format(
      "fibres along {} that only pull: {} % stiffer there than across when stretched (fibre "
      "modulus {} {}{})",
      vector_text(a), figure(100.0 * change), figure(values[0]),
      model.scene->capture.units.stress(), free ? ", exponent " + figure(values[1]) : "");
}

}  // namespace hookeye
