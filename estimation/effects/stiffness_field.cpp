#include <fmt/format.h>

#include "estimation/effects/graded_stiffness.h"
#include "estimation/effects/own_directions.h"
#include "estimation/effects/places.h"
#include "estimation/effects/stiffness_places.h"

namespace hookeye {

namespace {

const int kFieldBumps = 16, kBlobs = 16;
const char* const kFreeBlob = "free blob";
const char* const kFreeBall = "free ball";
const char* const kHalves = "halves across";

/// Element forces of what a field scales. At its null that is every part, for a candidate comes
/// last; once it is in, the parts with weights (an effect added after it appends its part without
/// any).
struct ScaledForces {
  ElementForces at_null{[](const Model& model, int example, const VectorXd& q) {
    return element_forces(model.scene->body->mesh, model.energy_of(example), q);
  }};
  ElementForces within{[](const Model& model, int example, const VectorXd& q) {
    const EnergyModel all = model.energy_of(example);
    EnergyModel scaled = all;
    scaled.parts.clear();
    for (size_t i = 0; i < all.parts.size(); ++i)
      if (model.energy.parts[i].weight.size() != 0) scaled.parts.push_back(all.parts[i]);
    return element_forces(model.scene->body->mesh, scaled, q);
  }};
};

/// Energy weights exp(sum_i a_i phi_i(X)), phi_i Gaussian bumps: stiffness varies over the body.
/// The refit may go on to one that changes along a direction, in two layers or within a ball
/// (graded_stiffness.h). Beside a place another may stand.
class StiffnessField final : public Effect {
 public:
  std::string name() const override { return "stiffness_field"; }
  EffectGroup group() const override { return EffectGroup::material; }
  std::string title() const override { return "stiffness varies over the body"; }
  std::string manual() const override {
    return "Some part of the body is stiffer or softer than the rest: an inclusion, a void, "
           "uneven cure, one half of a casting. A field can imitate much else (soft clamps, wrong "
           "loads), so it is believed only where one blob, or held-out examples, say the same. The "
           "refit goes on to a ball with an edge, to a stiffness that changes along a direction "
           "and to two layers. Beside one place another may stand.";
  }
  bool several() const override { return true; }

  Ingredients candidates(const Model& model, std::string*) const override {
    const Scene& scene = *model.scene;
    const double size = body_size(scene).size;
    auto forces = std::make_shared<ScaledForces>();
    Ingredients all = {
        field(model, spread_centres(scene, kFieldBumps), bump_radius(scene, kFieldBumps), forces)};
    for (const Vector3d& c : spread_centres(scene, kBlobs))
      all.push_back(blob(model, c, 0.12 * size, forces, 1));
    const Eigen::Matrix3d axes = own_axes(scene.body->mesh);
    for (int axis = 0; axis < 3; ++axis) all.push_back(halves(model, axes.col(axis), forces));
    return all;
  }

  /// Beside places, and nothing but places, one more.
  Ingredients candidates_beside(const Model& model, const Ingredients& standing,
                                std::string* why_not) const override {
    Ingredients all;
    if (!std::all_of(standing.begin(), standing.end(),
                     [](const auto& one) { return is_place(one->variant()); })) {
      if (why_not) *why_not = "already in the model";
      return all;
    }
    auto forces = std::make_shared<ScaledForces>();
    const double radius = 0.12 * body_size(*model.scene).size;
    for (const Vector3d& c : spread_centres(*model.scene, kBlobs))
      all.push_back(blob(model, c, radius, forces, next_place(standing)));
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    const auto [form, nth] = place_variant(variant);
    if (form == kFreeBlob) return free_blob(model, nth);
    if (auto graded = graded_form(model, variant)) return graded;
    if (auto places = places_form(model, variant)) return places;
    if (const auto across = across_of(variant))
      return halves(model, *across, std::make_shared<ScaledForces>());
    if (const auto place = blob_in(form))
      return blob(model, place->centre, place->radius, std::make_shared<ScaledForces>(), nth);
    const auto bumps = bumps_in(variant);
    if (!bumps) return nullptr;
    return field(model, bumps->centres, bumps->radius, std::make_shared<ScaledForces>());
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    switch (edge) {
      case FormEdge::refit:
        return freely_placed(model, from, values);
      case FormEdge::smaller:
        return likest_blob(model, from, values);
      case FormEdge::further:
        return further(model, from, values);
      default:
        return {};
    }
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    if (starts_with(ingredient.variant(), "field"))
      return fmt::format("stiffness varies over the body by factors from {} to {}",
                         figure(std::exp(values.minCoeff())), figure(std::exp(values.maxCoeff())));
    if (is_places(ingredient.variant())) return places_sentence(model, ingredient, values);
    if (is_graded(ingredient.variant())) return graded_sentence(model, ingredient, values);
    if (const auto across = across_of(ingredient.variant())) {
      const NextForm layers = layers_like(model, *across, values[0]);
      return graded_sentence(model, *layers.form, layers.values);
    }
    const Blob place = values.size() == 5 ? blob_of(ingredient, values)
                                          : *blob_in(place_variant(ingredient.variant()).form);
    return fmt::format("a {} place {} times as stiff as the rest, of radius {} {} around {}",
                       values[0] >= 0 ? "stiff" : "soft", figure(std::exp(values[0])),
                       figure(place.radius), model.scene->capture.units.length,
                       place_text(place.centre, body_size(*model.scene).size));
  }

 private:
  std::vector<NextForm> freely_placed(const Model& model, const Ingredient& scored,
                                      const VectorXd& values) const {
    if (const auto across = across_of(scored.variant()))
      return {layers_like(model, *across, values[0])};
    const auto [form, nth] = place_variant(scored.variant());
    const auto place = blob_in(form);
    if (!place) return {};
    return {{free_blob(model, nth), freed(*place, values[0])}};
  }

  /// The one blob that is most like the field but for its mean.
  std::vector<NextForm> likest_blob(const Model& model, const Ingredient& field,
                                    const VectorXd& values) const {
    const auto bumps = bumps_in(field.variant());
    if (!bumps) return {};
    const auto [place, amplitude] =
        likest_place(model.scene->body->mesh, bumps->centres, bumps->radius, values);
    return {{free_blob(model, 1), freed(place, amplitude)}};
  }

  std::vector<NextForm> further(const Model& model, const Ingredient& refitted,
                                const VectorXd& values) const {
    if (is_graded(refitted.variant())) return {};
    if (is_places(refitted.variant())) {
      const auto balls = balls_like(model, refitted, values);
      return balls ? std::vector<NextForm>{*balls} : std::vector<NextForm>{};
    }
    const auto [form, nth] = place_variant(refitted.variant());
    if (nth > 1) return {ball_like(model, values, nth)};
    Model one = model, with = model;
    one.energy.parts.resize(1);
    with.energy.parts.resize(1);
    refitted.apply(values, with);
    VectorXd factor = with.energy.parts[0].weight;
    if (const VectorXd& before = one.energy.parts[0].weight; before.size() > 0)
      factor = (before.array() > 0.0).select(factor.cwiseQuotient(before), 1.0);
    if (factor.size() == 0) factor = VectorXd::Ones(model.scene->body->mesh.size());
    auto all = further_grades(model, factor.array().log());
    if (const auto bumps = bumps_in(refitted.variant())) {
      const auto places = places_like(model, bumps->centres, bumps->radius, values);
      all.insert(all.begin(), places.begin(), places.end());
    }
    if (form == kFreeBlob) all.insert(all.begin(), ball_like(model, values));
    return all;
  }

  /// Free ones: a fixed one's derivative scales all parts that have weights, another place's too.
  static bool is_place(const std::string& variant) {
    const std::string form = place_variant(variant).form;
    return form == kFreeBlob || form == kFreeBall || is_places(variant);
  }

  struct Bumps {
    double radius;
    std::vector<Vector3d> centres;
  };
  static std::optional<Bumps> bumps_in(const std::string& variant) {
    const auto n = numbers_in(variant);
    if (!starts_with(variant, "field") || n.size() < 4 || n.size() % 3 != 1) return {};
    Bumps out{n[0], {}};
    for (size_t i = 1; i + 2 < n.size(); i += 3) out.centres.emplace_back(n[i], n[i + 1], n[i + 2]);
    return out;
  }

  static Parameter amplitude(const std::string& label) {
    return {label, "", "log of the stiffness factor", 0.0, -4.0, 4.0, 0.3, false};
  }

  std::shared_ptr<const Ingredient> linear(IngredientSpec spec, std::vector<VectorXd> bumps,
                                           std::shared_ptr<ScaledForces> forces) const {
    spec.name = name();
    spec.touches = {.energy = true};
    const auto phi = std::make_shared<const std::vector<VectorXd>>(std::move(bumps));
    spec.apply = [phi](const VectorXd& values, Model& m) {
      VectorXd log_factor = VectorXd::Zero(m.scene->body->mesh.size());
      for (size_t i = 0; i < phi->size(); ++i) log_factor += values[i] * (*phi)[i];
      scale_energy(m, log_factor);
    };
    // d(weight)/da_i = phi_i weight: element by element the present force times phi_i.
    spec.derivative = [phi, forces](const VectorXd& values, const Model& m, int example,
                                    const Equilibrium& equilibrium, int k,
                                    MechanicsDerivative& out) {
      ElementForces& source = values.isZero(0.0) ? forces->at_null : forces->within;
      const auto f = source.at(m, example, equilibrium.q);
      out.dR_dt = scatter(m.scene->body->mesh, *f, (*phi)[k]);
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  std::shared_ptr<const Ingredient> field(const Model& model, const std::vector<Vector3d>& centres,
                                          double radius,
                                          std::shared_ptr<ScaledForces> forces) const {
    IngredientSpec spec;
    spec.variant = fmt::format("field of bumps, radius {:g}, around", radius);
    std::vector<VectorXd> bumps;
    for (size_t i = 0; i < centres.size(); ++i) {
      const Vector3d& c = centres[i];
      spec.variant += fmt::format(" ({:g}, {:g}, {:g})", c.x(), c.y(), c.z());
      spec.parameters.push_back(amplitude(fmt::format("stiffness_field.a{}", i + 1)));
      bumps.push_back(gaussian_bump(model.scene->body->mesh, centres[i], radius));
    }
    return linear(std::move(spec), std::move(bumps), std::move(forces));
  }

  std::shared_ptr<const Ingredient> blob(const Model& model, const Vector3d& centre, double radius,
                                         std::shared_ptr<ScaledForces> forces, int place) const {
    radius = std::stod(fmt::format("{:.3g}", radius));
    IngredientSpec spec;
    spec.variant = as_place(blob_text({centre, radius}), place);
    spec.parameters = of_place({amplitude("stiffness_field.a")}, place);
    return linear(std::move(spec), {gaussian_bump(model.scene->body->mesh, centre, radius)},
                  std::move(forces));
  }

  static std::optional<Vector3d> across_of(const std::string& variant) {
    const auto n = numbers_in(variant);
    if (!starts_with(variant, kHalves) || n.size() != 3) return std::nullopt;
    return Vector3d(n[0], n[1], n[2]);
  }

  /// One half of the body stiffer and the other softer by as much, parted across `across` in the
  /// middle: as two castings in one mould are. No sign of `across` is another candidate.
  std::shared_ptr<const Ingredient> halves(const Model& model, const Vector3d& across,
                                           std::shared_ptr<ScaledForces> forces) const {
    IngredientSpec spec;
    spec.variant = fmt::format("{} {}", kHalves, direction_text(across));
    const Vector3d n = across_of(spec.variant)->normalized();
    const BodySize body = body_size(*model.scene);
    const VectorXd t =
        (element_centres(model.scene->body->mesh).colwise() - body.centre).transpose() * n;
    spec.parameters = {amplitude("stiffness_field.a")};
    return linear(std::move(spec), {0.5 * (t.array() / (0.1 * body.size)).tanh()},
                  std::move(forces));
  }

  std::shared_ptr<const Ingredient> free_blob(const Model& model, int place) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = as_place(kFreeBlob, place);
    spec.parameters = of_place(free_place(model), place);
    spec.touches = {.energy = true};
    spec.apply = [](const VectorXd& v, Model& m) {
      if (v[0] == 0.0) return;
      scale_energy(m, v[0] * gaussian_bump(m.scene->body->mesh, v.segment<3>(1), v[4]));
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(stiffness_field, StiffnessField)
