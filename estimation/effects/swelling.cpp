#include <fmt/format.h>

#include <Eigen/QR>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

const int kSwellingBlobs = 12, kSwellingBumps = 16;
const char* const kFreeGradient = "free gradient";

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

using Fields = std::vector<VectorXd>;

/// 1 + sum of the fields, each times its value; kept off zero, where a body cannot be.
VectorXd stretch_of(const Fields& phi, const VectorXd& values) {
  VectorXd g = VectorXd::Ones(phi.front().size());
  for (size_t i = 0; i < phi.size(); ++i) g += values[i] * phi[i];
  return g.cwiseMax(0.1);
}

/// Everywhere, and along the axes by the body's size from its middle.
Fields linear_fields(const Scene& scene) {
  const TetMesh& mesh = scene.body->mesh;
  const BodySize body = body_size(scene);
  const Matrix3Xd x = (element_centres(mesh).colwise() - body.centre) / body.size;
  return {VectorXd::Ones(mesh.size()), x.row(0), x.row(1), x.row(2)};
}

/// F = F_elastic g, g = 1 + s phi(X): a change of size without stress. The refit may go on to one
/// that changes along a direction, or to a smooth field.
class Swelling final : public Effect {
 public:
  std::string name() const override { return "swelling"; }
  EffectGroup group() const override { return EffectGroup::loads; }
  std::string title() const override { return "swelling"; }
  std::string manual() const override {
    return "The body has grown or shrunk since its rest shape was taken: moisture, heat, cure, "
           "drying; everywhere or in one place. Easily taken for gravity or for a camera that "
           "moved closer; it shows in the rest photos as well. The refit goes on to a swelling "
           "that "
           "changes along a direction, then to a smooth field.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    const Scene& scene = *model.scene;
    auto forces = forces_by_log_stretch();
    Ingredients all = {uniform(model, forces)};
    const double radius = 0.15 * body_size(scene).size;
    for (const Vector3d& c : spread_centres(scene, kSwellingBlobs))
      all.push_back(blob(model, c, radius, forces));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    if (variant == "free blob") return free_blob(model);
    if (variant == kFreeGradient) return gradient(model);
    const auto n = numbers_in(variant);
    if (starts_with(variant, "field") && n.size() > 3 && n.size() % 3 == 1) {
      std::vector<Vector3d> centres;
      for (size_t i = 1; i + 2 < n.size(); i += 3) centres.emplace_back(n[i], n[i + 1], n[i + 2]);
      return field(model, centres, n[0]);
    }
    const auto place = blob_in(variant);
    if (!place) return nullptr;
    return blob(model, place->centre, place->radius, forces_by_log_stretch());
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge == FormEdge::further) return gradient_and_field(model, from, values);
    const auto place = blob_in(from.variant());
    if (edge != FormEdge::refit || !place) return {};
    return {{free_blob(model), freed(*place, values[0])}};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const std::string change =
        fmt::format("{} by {} % in length", values[0] >= 0 ? "swollen" : "shrunk",
                    figure(100.0 * std::abs(values[0])));
    if (ingredient.variant() == "uniform") return "the body has " + change;
    if (ingredient.variant() == kFreeGradient) {
      const Vector3d g = values.tail(3);
      return fmt::format(
          "the body has in its middle {}, and {} % more along {} over its size of {} {}", change,
          figure(100.0 * g.norm()), vector_text(g.normalized()),
          figure(body_size(*model.scene).size), model.scene->capture.units.length);
    }
    if (starts_with(ingredient.variant(), "field")) {
      const auto n = numbers_in(ingredient.variant());
      std::vector<Vector3d> centres;
      for (size_t i = 1; i + 2 < n.size(); i += 3) centres.emplace_back(n[i], n[i + 1], n[i + 2]);
      const VectorXd g = stretch_of(field_of_bumps(*model.scene, centres, n[0]), values);
      return fmt::format("the body has changed its size unevenly, by {} to {} % in length",
                         figure(100.0 * (g.minCoeff() - 1.0)),
                         figure(100.0 * (g.maxCoeff() - 1.0)));
    }
    const Blob place = blob_of(ingredient, values);
    return fmt::format("a place of radius {} {} around {} has {}", figure(place.radius),
                       model.scene->capture.units.length,
                       place_text(place.centre, body_size(*model.scene).size), change);
  }

 private:
  std::vector<NextForm> gradient_and_field(const Model& model, const Ingredient& refitted,
                                           const VectorXd& values) const {
    if (starts_with(refitted.variant(), "field")) return {};
    const Scene& scene = *model.scene;
    Model with = model;
    refitted.apply(values, with);
    VectorXd present = VectorXd::Ones(scene.body->mesh.size());
    if (with.energy.swelling.size() > 0) present = with.energy.swelling;
    if (model.energy.swelling.size() > 0) present = present.cwiseQuotient(model.energy.swelling);
    const double radius = bump_radius(scene, kSwellingBumps);
    const auto centres = spread_centres(scene, kSwellingBumps);
    const std::vector<NextForm> all = {
        {gradient(model), in_fields(linear_fields(scene), present)},
        {field(model, centres, radius),
         in_fields(field_of_bumps(scene, centres, radius), present)}};
    return refitted.variant() == kFreeGradient ? std::vector<NextForm>{all[1]} : all;
  }

  static Parameter stretch() {
    return {"swelling.s", "", "change of length", 0.0, -0.5, 1.0, 0.01, false};
  }

  /// Values whose fields are nearest to `stretch`, as volumes count.
  static VectorXd in_fields(const Fields& phi, const VectorXd& stretch) {
    Eigen::MatrixXd A(stretch.size(), phi.size());
    for (size_t i = 0; i < phi.size(); ++i) A.col(i) = phi[i];
    return A.colPivHouseholderQr().solve(VectorXd(stretch.array() - 1.0));
  }

  static Fields field_of_bumps(const Scene& scene, const std::vector<Vector3d>& centres,
                               double radius) {
    Fields phi = {VectorXd::Ones(scene.body->mesh.size())};
    for (const Vector3d& c : centres) phi.push_back(gaussian_bump(scene.body->mesh, c, radius));
    return phi;
  }

  std::shared_ptr<const Ingredient> of_fields(std::string variant, Fields fields,
                                              std::vector<Parameter> parameters,
                                              std::shared_ptr<ElementForces> forces) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = std::move(variant);
    spec.parameters = std::move(parameters);
    spec.touches = {.energy = true};
    const auto phi = std::make_shared<const Fields>(std::move(fields));
    spec.apply = [phi](const VectorXd& v, Model& m) { swell(m, stretch_of(*phi, v)); };
    spec.derivative = [phi, forces](const VectorXd& v, const Model& m, int example,
                                    const Equilibrium& equilibrium, int k,
                                    MechanicsDerivative& out) {
      const auto f = forces->at(m, example, equilibrium.q);
      out.dR_dt = scatter(m.scene->body->mesh, *f, (*phi)[k].cwiseQuotient(stretch_of(*phi, v)));
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> of_field(std::string variant, VectorXd phi,
                                             std::shared_ptr<ElementForces> forces) const {
    return of_fields(std::move(variant), {std::move(phi)}, {stretch()}, std::move(forces));
  }

  std::shared_ptr<const Ingredient> gradient(const Model& model) const {
    std::vector<Parameter> parameters = {stretch()};
    for (char axis : {'x', 'y', 'z'})
      parameters.push_back({fmt::format("swelling.g{}", axis), "",
                            fmt::format("change of length over the body's size along {}", axis),
                            0.0, -2.0, 2.0, 0.02, false});
    return of_fields(kFreeGradient, linear_fields(*model.scene), std::move(parameters),
                     forces_by_log_stretch());
  }

  std::shared_ptr<const Ingredient> field(const Model& model, const std::vector<Vector3d>& centres,
                                          double radius) const {
    std::string variant = fmt::format("field of bumps, radius {:g}, around", radius);
    std::vector<Parameter> parameters = {stretch()};
    for (size_t i = 0; i < centres.size(); ++i) {
      variant += fmt::format(" ({:g}, {:g}, {:g})", centres[i].x(), centres[i].y(), centres[i].z());
      Parameter a = stretch();
      a.name = fmt::format("swelling.a{}", i + 1);
      a.long_name = fmt::format("change of length at bump {}", i + 1);
      parameters.push_back(a);
    }
    return of_fields(std::move(variant), field_of_bumps(*model.scene, centres, radius),
                     std::move(parameters), forces_by_log_stretch());
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
