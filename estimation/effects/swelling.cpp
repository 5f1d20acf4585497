#include <fmt/format.h>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

const int kBlobs = 12;

/// d(element force)/d(log g) by a central difference of one assembly: f_e depends on its own g_e
/// only, so that all fields share it.
std::shared_ptr<ElementForces> forces_by_log_stretch() {
  return std::make_shared<ElementForces>([](const Model& model, int example, const VectorXd& q) {
    const TetMesh& mesh = model.scene->body->mesh;
    const double h = 1e-4;
    auto shifted = [&](double log_stretch) {
      EnergyModel energy = model.energy_of(example);
      if (energy.swelling.size() == 0) energy.swelling = VectorXd::Ones(mesh.size());
      energy.swelling *= std::exp(log_stretch);
      return element_forces(mesh, energy, q);
    };
    return Eigen::MatrixXd((shifted(h) - shifted(-h)) / (2.0 * h));
  });
}

void swell(Model& model, const VectorXd& stretch) {
  VectorXd& g = model.energy.swelling;
  g = g.size() == 0 ? stretch : VectorXd(g.cwiseProduct(stretch));
}

/// F = F_elastic g, g = 1 + s phi(X): a change of size without stress.
class Swelling final : public Effect {
 public:
  std::string name() const override { return "swelling"; }
  EffectGroup group() const override { return EffectGroup::loads; }
  std::string title() const override { return "swelling"; }
  std::string manual() const override {
    return "The body has grown or shrunk since its rest shape was taken: moisture, heat, cure, "
           "drying; everywhere or in one place. Easily taken for gravity or for a camera that "
           "moved closer; it shows in the rest photos as well.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    const Scene& scene = *model.scene;
    auto forces = forces_by_log_stretch();
    Ingredients all = {uniform(model, forces)};
    const double radius = 0.15 * body_size(scene).size;
    for (const Vector3d& c : spread_centres(scene, kBlobs))
      all.push_back(blob(model, c, radius, forces));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    if (variant == "free blob") return free_blob(model);
    const auto place = blob_in(variant);
    if (!place) return nullptr;
    return blob(model, place->centre, place->radius, forces_by_log_stretch());
  }

  std::shared_ptr<const Ingredient> refit_form(const Model& model,
                                               std::shared_ptr<const Ingredient> scored,
                                               VectorXd& values) const override {
    const auto place = blob_in(scored->variant());
    if (!place) return scored;
    values = freed(*place, values[0]);
    return free_blob(model);
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const std::string change =
        fmt::format("{} by {} % in length", values[0] >= 0 ? "swollen" : "shrunk",
                    figure(100.0 * std::abs(values[0])));
    if (ingredient.variant() == "uniform") return "the body has " + change;
    const Blob place = blob_of(ingredient, values);
    return fmt::format("a place of radius {} {} around {} has {}", figure(place.radius),
                       model.scene->capture.units.length, vector_text(place.centre, 1), change);
  }

 private:
  static Parameter stretch() {
    return {"swelling.s", "", "change of length", 0.0, -0.5, 1.0, 0.01, false};
  }

  std::shared_ptr<const Ingredient> of_field(std::string variant, VectorXd phi,
                                             std::shared_ptr<ElementForces> forces) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = std::move(variant);
    spec.parameters = {stretch()};
    spec.touches = {.energy = true};
    spec.apply = [phi](const VectorXd& v, Model& m) { swell(m, (1.0 + v[0] * phi.array())); };
    spec.derivative = [phi, forces](const VectorXd& v, const Model& m, int example,
                                    const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
      const auto f = forces->at(m, example, equilibrium.q);
      out.dR_dt = scatter(m.scene->body->mesh, *f, phi.array() / (1.0 + v[0] * phi.array()));
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> uniform(const Model& model,
                                            std::shared_ptr<ElementForces> forces) const {
    return of_field("uniform", VectorXd::Ones(model.scene->body->mesh.size()), std::move(forces));
  }

  std::shared_ptr<const Ingredient> blob(const Model& model, const Vector3d& centre, double radius,
                                         std::shared_ptr<ElementForces> forces) const {
    radius = std::stod(fmt::format("{:.3g}", radius));
    return of_field(blob_text({centre, radius}),
                    gaussian_bump(model.scene->body->mesh, centre, radius), std::move(forces));
  }

  std::shared_ptr<const Ingredient> free_blob(const Model& model) const {
    const BodySize body = body_size(*model.scene);
    const std::string length = model.scene->capture.units.length;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = "free blob";
    spec.parameters = {stretch()};
    for (int i = 0; i < 3; ++i)
      spec.parameters.push_back({fmt::format("swelling.{}", "xyz"[i]), length,
                                 fmt::format("centre of the blob, {}", "xyz"[i]), body.centre[i],
                                 body.low[i], body.high[i], 0.1 * body.size, false});
    spec.parameters.push_back({"swelling.radius", length, "radius of the blob", 0.15 * body.size,
                               0.02 * body.size, 2.0 * body.size, 0.1 * body.size, true});
    spec.touches = {.energy = true};
    spec.apply = [](const VectorXd& v, Model& m) {
      if (v[0] == 0.0) return;
      swell(m, 1.0 + v[0] * gaussian_bump(m.scene->body->mesh, v.segment<3>(1), v[4]).array());
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(swelling, Swelling)
