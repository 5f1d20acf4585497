#include <fmt/format.h>

#include "estimation/effects/fibre_forms.h"
#include "estimation/effects/own_directions.h"

namespace hookeye {

namespace {

/// E_jj, E_kk and E_jk of the two axes across `axis` with one modulus: W = k/2 (E_jj^2 + E_kk^2 +
/// 2 E_jk^2), the same in all directions of that plane.
AdditiveModel plane_across(const AdditiveModel& base, int axis, double k) {
  const int low = axis == 0 ? 1 : 0, high = axis == 2 ? 1 : 2;
  AdditiveModel out = in_frame_of(base);
  const auto add = [&](int i, int j, double modulus) {
    add_addend(out, fmt::format("E{}{}", i + 1, j + 1), {0.0}, {}, VectorXd::Constant(1, modulus));
  };
  add(low, low, k);
  add(high, high, k);
  add(low, high, 2.0 * k);
  return out;
}

AdditiveModel fibres_along(const AdditiveModel& base, const Vector3d& a, double k) {
  AdditiveModel out = in_frame_of(base);
  add_addend(out, "fibre1", {0.0}, {}, VectorXd::Constant(1, k));
  out.components[0].direction = a.normalized();
  return out;
}

/// W += k/2 (I4bar - 1)^2: one family of fibres, acting in tension and compression alike or in
/// tension only; the refit may go on to stiffnesses of their own (fibre_forms.h). Of an
/// additive material a function of the fibres' stretch, k/2 (lambda - 1)^2 with k >= 0, or one
/// modulus in the plane across an axis of its frame, which makes that axis the softer one.
class Anisotropy final : public Effect {
 public:
  std::string name() const override { return "anisotropy"; }
  EffectGroup group() const override { return EffectGroup::material; }
  std::string title() const override { return "anisotropy"; }
  std::string manual() const override {
    return "The material is stiffer (or softer) along one direction of the rest state: fibres, "
           "print lines, rolling. Easily taken for a soft clamp or a misaligned load; pulls along "
           "two directions tell. Fibres may pull and push alike, or only pull; where both leave "
           "more than noise, the refit goes on to stiffnesses of their own along and across "
           "(transverse isotropy, orthotropy, all constants), with the law that FEM codes have for "
           "them, linear between stress and Green strain, where it is nearer than the told one.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    Ingredients all;
    const auto lines = own_lines(model.scene->body->mesh);
    for (const Vector3d& line : lines) all.push_back(along(model, line));
    if (additive_base(model)) {
      for (int axis = 0; axis < 3; ++axis) all.push_back(across(model, axis));
      return all;
    }
    for (const Vector3d& line : lines) all.push_back(pulling_along(model, line));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    const auto numbers = numbers_in(variant);
    for (int axis = 0; axis < 3; ++axis)
      if (additive_base(model) && variant == fmt::format("across axis {}", axis + 1))
        return across(model, axis);
    if (!additive_base(model))
      if (auto form = fibre_form(model, variant)) return form;
    if (numbers.size() != 3) return nullptr;
    const Vector3d a(numbers[0], numbers[1], numbers[2]);
    if (starts_with(variant, "along")) return along(model, a);
    return starts_with(variant, "free around") ? free_around(model, a) : nullptr;
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    switch (edge) {
      case FormEdge::refit:
        return refits(model, from, values);
      case FormEdge::plainer:
        return plainer_stiffnesses(model, from, values);
      case FormEdge::further:
        return further_fibres(model, from, values);
      default:
        return {};
    }
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    if (const auto said = fibre_sentence(model, ingredient, values); !said.empty()) return said;
    const auto n = numbers_in(ingredient.variant());
    const double mu = initial_shear_modulus(model.energy);
    const std::string stress = model.scene->capture.units.stress();
    // Pulled by e, incompressible: (e, -e/2) in the plane gives 5/4 k, and along the axis, -e/2
    // twice in the plane, 1/2 k.
    if (starts_with(ingredient.variant(), "across"))
      return fmt::format("{} % stiffer in the plane across axis {:g} than along it (modulus {} {})",
                         figure(100.0 * 0.75 * values[0] / (3.0 * mu)), n.at(0), figure(values[0]),
                         stress);
    Vector3d a = Vector3d(n.at(0), n.at(1), n.at(2)).normalized();
    if (values.size() == 3) a = turned(a, values[1], values[2]);
    if (a.z() < 0.0) a = -a;
    // Uniaxial modulus along a: 3 mu + d2W/de2 with I4bar - 1 = 2 e, hence 4 k; lambda - 1 = e.
    const double change = (additive_base(model) ? 1.0 : 4.0) * values[0] / (3.0 * mu);
    return fmt::format("{} % {} along {} than across (fibre modulus {} {})",
                       figure(100.0 * std::abs(change)), change >= 0 ? "stiffer" : "softer",
                       vector_text(a), figure(values[0]), stress);
  }

 private:
  std::vector<NextForm> refits(const Model& model, const Ingredient& scored,
                               const VectorXd& values) const {
    if (!additive_base(model))
      if (auto pulling = refit_of_pulling(model, scored, values); !pulling.empty()) return pulling;
    const auto numbers = numbers_in(scored.variant());
    if (!starts_with(scored.variant(), "along") || numbers.size() != 3) return {};
    return {{free_around(model, Vector3d(numbers[0], numbers[1], numbers[2])),
             Vector3d(values[0], 0.0, 0.0)}};
  }

  static Parameter stiffness(const Model& model) {
    const double mu = initial_shear_modulus(model.energy);
    return {"anisotropy.k",
            model.scene->capture.units.stress(),
            "fibre modulus",
            0.0,
            additive_base(model) ? 0.0 : -0.5 * mu,  // a softer fibre alone is not convex
            1e3 * mu,
            mu,
            false};
  }

  std::shared_ptr<const Ingredient> across(const Model& model, int axis) const {
    FunctionSpec spec;
    spec.name = name();
    spec.variant = fmt::format("across axis {}", axis + 1);
    spec.parameters = {stiffness(model)};
    spec.parameters[0].long_name = "modulus of the plane";
    spec.functions = [base = in_frame_of(*additive_base(model)), axis](const VectorXd& values) {
      return plane_across(base, axis, values[0]);
    };
    return additive_function(std::move(spec));
  }

  std::shared_ptr<const Ingredient> fibre_function(const Model& model, const Vector3d& a,
                                                   std::string variant,
                                                   std::vector<Parameter> parameters) const {
    FunctionSpec spec;
    spec.name = name();
    spec.variant = std::move(variant);
    spec.parameters = std::move(parameters);
    spec.functions = [base = in_frame_of(*additive_base(model)), a](const VectorXd& values) {
      return fibres_along(base, values.size() == 3 ? turned(a, values[1], values[2]) : a,
                          values[0]);
    };
    return additive_function(std::move(spec));
  }

  std::shared_ptr<const Ingredient> along(const Model& model, const Vector3d& a) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = fmt::format("along {}", direction_text(a));
    spec.parameters = {stiffness(model)};
    if (additive_base(model)) return fibre_function(model, a, spec.variant, spec.parameters);
    spec.touches = {.energy = true};
    spec.apply = [a](const VectorXd& values, Model& m) { add_part(m.energy, fibre(values[0], a)); };
    spec.derivative = [a](const VectorXd& values, const Model& m, int example,
                          const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
      if (values[0] != 0.0) return false;
      out.dR_dt = part_force(m, example, equilibrium.q, fibre(1.0, a));
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> free_around(const Model& model, const Vector3d& a) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = fmt::format("free around {}", direction_text(a));
    spec.parameters = {
        stiffness(model),
        {"anisotropy.angle1", "rad", "first angle of the fibre", 0.0, -3.2, 3.2, 0.2, false},
        {"anisotropy.angle2", "rad", "second angle of the fibre", 0.0, -3.2, 3.2, 0.2, false}};
    if (additive_base(model)) return fibre_function(model, a, spec.variant, spec.parameters);
    spec.touches = {.energy = true};
    spec.apply = [a](const VectorXd& values, Model& m) {
      if (values[0] == 0.0) return;
      add_part(m.energy, fibre(values[0], turned(a, values[1], values[2])));
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(anisotropy, Anisotropy)
