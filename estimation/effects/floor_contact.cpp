#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// Distances of the planes from the rest body, in parts of its size.
const double kGaps[] = {0.005, 0.05, 0.15};
const char* const kSides[] = {"+x", "-x", "+y", "-y", "+z", "-z"};

/// Side of the body on which the floor stands: outward direction.
Vector3d outward(int side) { return (side % 2 == 0 ? 1.0 : -1.0) * Vector3d::Unit(side / 2); }

/// Distance of the body's outermost rest point along a side, from the origin.
double reach(const Scene& scene, int side) {
  const BodySize body = body_size(scene);
  return side % 2 == 0 ? body.high[side / 2] : -body.low[side / 2];
}

double smoothing(const Scene& scene) { return 0.002 * body_size(scene).size; }

std::shared_ptr<const ForceTerm> plane(const Model& model, int side, double position, double k) {
  return floor_contact(model.scene->body->mesh, position * outward(side), -outward(side), k,
                       smoothing(*model.scene));
}

/// Something flat that the deformed body touches and was not told. Scored by the contact stiffness
/// (slope at 0 where the present equilibrium reaches through the plane), refitted with a cushion of
/// free position and stiffness, and from there with a hard floor, which has one number less.
class FloorContact final : public Effect {
 public:
  std::string name() const override { return "floor_contact"; }
  EffectGroup group() const override { return EffectGroup::supports; }
  std::string title() const override { return "contact with a floor or wall"; }
  std::string manual() const override {
    return "The deformed body touches a table, a wall or a jaw that was not told. Easily taken "
           "for stiffening or for a misaligned load; it changes only the examples that reach "
           "the plane. Refitted as a cushion of free position and stiffness, and as a hard floor, "
           "which stays where it explains as much.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    const double size = body_size(*model.scene).size;
    Ingredients all;
    for (int side = 0; side < 6; ++side)
      for (double gap : kGaps)
        all.push_back(soft(model, side, reach(*model.scene, side) + gap * size));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    for (int side = 0; side < 6; ++side) {
      const std::string label = fmt::format("plane at {}", kSides[side]);
      const auto n = numbers_in(variant);
      if (starts_with(variant, label) && n.size() == 1) return soft(model, side, n[0]);
      if (variant == cushion_on(side)) return cushion(model, side);
      if (variant == hard_on(side)) return hard(model, side);
    }
    return nullptr;
  }

  std::shared_ptr<const Ingredient> refit_form(const Model& model,
                                               std::shared_ptr<const Ingredient> scored,
                                               VectorXd& values) const override {
    const auto n = numbers_in(scored->variant());
    for (int side = 0; side < 6; ++side)
      if (starts_with(scored->variant(), fmt::format("plane at {}", kSides[side])) &&
          n.size() == 1) {
        values = Eigen::Vector2d(n[0], values[0]);
        return cushion(model, side);
      }
    return scored;
  }

  std::shared_ptr<const Ingredient> smaller_form(const Model& model, const Ingredient& refitted,
                                                 VectorXd& values) const override {
    for (int side = 0; side < 6; ++side)
      if (refitted.variant() == cushion_on(side)) {
        values.conservativeResize(1);
        return hard(model, side);
      }
    return nullptr;
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const std::string length = model.scene->capture.units.length;
    const std::string unit = model.scene->capture.units.stress() + "/" + length;
    for (int side = 0; side < 6; ++side) {
      const bool soft = ingredient.variant() == cushion_on(side);
      if (soft || ingredient.variant() == hard_on(side))
        return fmt::format(
            "the body touches a {} on its {} side, {} {} from where it ends at rest{}",
            soft ? "cushion" : "plane", kSides[side], figure(values[0] - reach(*model.scene, side)),
            length, soft ? fmt::format(" (stiffness {} {})", figure(values[1]), unit) : "");
    }
    return fmt::format("the body touches a {} (contact stiffness {} {})", ingredient.variant(),
                       figure(values[0]), unit);
  }

 private:
  static std::string hard_on(int side) {
    return fmt::format("hard plane on side {}", kSides[side]);
  }
  static std::string cushion_on(int side) {
    return fmt::format("cushion on side {}", kSides[side]);
  }

  std::shared_ptr<const Ingredient> soft(const Model& model, int side, double position) const {
    position = std::stod(fmt::format("{:.5g}", position));
    const double mu = initial_shear_modulus(model.energy);
    const double size = body_size(*model.scene).size;
    const Units& units = model.scene->capture.units;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = fmt::format("plane at {} side, position {:g}", kSides[side], position);
    spec.parameters = {{"floor_contact.k", units.stress() + "/" + units.length, "contact stiffness",
                        0.0, 0.0, 1e4 * mu / size, 0.1 * mu / size, false}};
    spec.touches = {.loading = true};
    spec.apply = [side, position](const VectorXd& k, Model& m) {
      const auto force = plane(m, side, position, k[0]);
      for (auto& example : m.examples) example.loading.forces.push_back(force);
    };
    spec.derivative = [side, position](const VectorXd&, const Model& m, int,
                                       const Equilibrium& equilibrium, int,
                                       MechanicsDerivative& out) {
      Loading alone;  // linear in k
      alone.forces.push_back(plane(m, side, position, 1.0));
      out.dR_dt = residual(m.scene->body->mesh, EnergyModel{}, alone, equilibrium.q);
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  static Parameter position(const Scene& scene, int side) {
    const double size = body_size(scene).size, rest = reach(scene, side);
    return {"floor_contact.position",
            scene.capture.units.length,
            fmt::format("where the plane stands along {}", kSides[side]),
            rest + 0.05 * size,
            rest - 0.02 * size,
            rest + size,
            0.01 * size,
            false};
  }

  std::shared_ptr<const Ingredient> cushion(const Model& model, int side) const {
    const Scene& scene = *model.scene;
    const Units& units = scene.capture.units;
    const double k = 0.1 * initial_shear_modulus(model.energy) / body_size(scene).size;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = cushion_on(side);
    spec.has_null = false;
    spec.parameters = {position(scene, side),
                       {"floor_contact.k", units.stress() + "/" + units.length, "contact stiffness",
                        k, 1e-4 * k, 1e5 * k, k, true}};
    spec.touches = {.loading = true};
    spec.apply = [side](const VectorXd& values, Model& m) {
      const auto force = plane(m, side, values[0], values[1]);
      for (auto& example : m.examples) example.loading.forces.push_back(force);
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> hard(const Model& model, int side) const {
    const Scene& scene = *model.scene;
    // A traction of mu/5 sinks in by 0.2 % of the size.
    const double k = 100.0 * initial_shear_modulus(model.energy) / body_size(scene).size;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = hard_on(side);
    spec.has_null = false;
    spec.parameters = {position(scene, side)};
    spec.touches = {.loading = true};
    spec.apply = [side, k](const VectorXd& values, Model& m) {
      const auto force = plane(m, side, values[0], k);
      for (auto& example : m.examples) example.loading.forces.push_back(force);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(floor_contact, FloorContact)
