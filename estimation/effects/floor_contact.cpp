#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/effects/floor_planes.h"
#include "estimation/effects/own_directions.h"
#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// Distances of the planes from the rest body, in parts of its size.
const double kGaps[] = {0.005, 0.05, 0.15};
/// Part of the size that the body has to move outward before a plane between the axes is tried,
/// half of it behind the plane: twenty times the depth over which its force sets in (smoothing).
constexpr double kLeastTravel = 0.02;
/// Half a step of the grid of directions [rad], 38 degrees at most: nearer to an axis than that, a
/// fitted plane is asked whether it is normal to it.
constexpr double kHalfStep = 0.335;

/// By how much a side of a body that stands along the frame may lean [rad]: a draft, a taper, the
/// bumps of a cast.
constexpr double kLeaning = 0.1;

/// By how much a plane is softer from which a hard one starts (penalty continuation, Fiacco and
/// McCormick 1968). Where an edge meets a hard plane, chi has a kink over the tilt at which the
/// plane changes from one corner to another, and steps end there; one that gives by as much as it
/// moves the body passes.
constexpr double kSofter = 30.0;

/// Distance of the body's outermost rest point along a direction, from the origin.
double reach(const Scene& scene, const Vector3d& direction) {
  return (direction.transpose() * scene.body->mesh.X).maxCoeff();
}

/// Depth over which the force sets in: some 0.15 px where the body fills 300. An edge that is
/// sharper meets the points of a face one by one.
double smoothing(const Scene& scene) { return 0.0005 * body_size(scene).size; }

std::shared_ptr<const ForceTerm> force_of(const Model& model, const Plane& plane, double k) {
  return floor_contact(model.scene->body->mesh, plane.through, -plane.out, k,
                       smoothing(*model.scene));
}

/// A tenth of the body's own, mu over its size: a cushion's at the start.
double soft_stiffness(const Model& model) {
  return 0.1 * initial_shear_modulus(model.energy) / body_size(*model.scene).size;
}

/// A traction of mu/5 sinks into a hard plane by 0.03 % of the size, less than 0.1 px where the
/// body fills 300. Ten times as much is seen, and what else is fitted makes up for it.
double hard_stiffness(const Model& model) { return 3e4 * soft_stiffness(model); }

void stand(Model& model, const Plane& plane, double k) {
  const auto force = force_of(model, plane, k);
  for (auto& example : model.examples) example.loading.forces.push_back(force);
}

/// Deformed positions (3 x nodes) of the fitted examples whose equilibrium is known.
std::vector<Matrix3Xd> fitted_positions(const Model& model) {
  const TetMesh& mesh = model.scene->body->mesh;
  std::vector<Matrix3Xd> all;
  for (size_t e = 0; e < model.states.size(); ++e)
    if (model.states[e] && !model.scene->capture.examples[e].validate)
      all.emplace_back(model.states[e]->q.reshaped(3, mesh.nodes()));
  return all;
}

/// How far outward the body moves along `direction` in each fitted example, the farthest first.
std::vector<double> travels(const Model& model, const Vector3d& direction) {
  const double rest = reach(*model.scene, direction);
  std::vector<double> all;
  for (const Matrix3Xd& x : fitted_positions(model))
    all.push_back((direction.transpose() * x).maxCoeff() - rest);
  std::sort(all.rbegin(), all.rend());
  return all;
}

std::vector<double> gaps_at_axes(double size) {
  std::vector<double> all;
  for (const double gap : kGaps) all.push_back(gap * size);
  return all;
}

/// From the rest body to half-way where each example moves along a direction, but for those that
/// reach such a plane already.
std::vector<double> gaps_between_axes(const Model& model, const Vector3d& direction) {
  const double size = body_size(*model.scene).size;
  std::vector<double> all;
  for (const double travel : travels(model, direction)) {
    if (travel < kLeastTravel * size) break;
    if (all.empty() || travel <= all.back()) all.push_back(0.5 * travel);
  }
  return all;
}

/// Where the known states press against the plane, in the mean weighted by depth; what is next to
/// the plane of the rest body's middle, where none does.
Vector3d pressed(const Model& model, const ScoredPlane& scored) {
  Vector3d sum = Vector3d::Zero();
  double weight = 0.0;
  for (const Matrix3Xd& x : fitted_positions(model))
    for (Eigen::Index node = 0; node < x.cols(); ++node) {
      const double depth = scored.out.dot(x.col(node)) - scored.position;
      if (depth > 0.0) sum += depth * x.col(node), weight += depth;
    }
  const BodySize body = body_size(*model.scene);
  const Vector3d centre = weight > 0.0 ? Vector3d(sum / weight) : body.centre;
  return rounded(centre - (scored.out.dot(centre) - scored.position) * scored.out, body.size);
}

/// Something flat that the deformed body touches and was not told. Scored by the contact stiffness
/// (slope at 0 where the present equilibrium reaches through the plane), refitted with a cushion of
/// free position, tilt and stiffness, and from there with a hard floor, which has one number less.
class FloorContact final : public Effect {
 public:
  std::string name() const override { return "floor_contact"; }
  EffectGroup group() const override { return EffectGroup::supports; }
  std::string title() const override { return "contact with a floor or wall"; }
  std::string manual() const override {
    return "The deformed body touches a table, a wall or a jaw that was not told. Easily taken "
           "for stiffening or for a misaligned load; it changes only the examples that reach "
           "the plane. Beside planes normal to the body's own axes, 44 directions between them are "
           "tried where the deformed body moves outward. Refitted as a cushion of free position "
           "and "
           "stiffness, which may tilt unless it stands normal to an axis of the capture's frame, "
           "and "
           "as a hard floor, which stays where it explains as much; so does a plane normal to "
           "such an axis, which may tilt too where it leaves more than noise.";
  }

  Ingredients candidates(const Model& model, std::string*) const override {
    const double size = body_size(*model.scene).size;
    Ingredients all;
    const auto lines = own_lines(model.scene->body->mesh);
    for (size_t i = 0; i < lines.size(); ++i)
      for (const double sign : {1.0, -1.0}) {
        const Vector3d out = sign * lines[i] + Vector3d::Zero();  // no -0
        const double rest = reach(*model.scene, out.normalized());
        for (const double gap :
             i < kAxes ? gaps_at_axes(size) : gaps_between_axes(model, out.normalized()))
          all.push_back(soft(model, plane_at(out, rest + gap, size)));
      }
    return all;
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    if (const auto scored = scored_plane(variant)) return soft(model, *scored);
    if (const auto form = plane_form(variant)) return refitted(model, *form);
    return nullptr;
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    switch (edge) {
      case FormEdge::refit:
        return freed_planes(model, from, values);
      case FormEdge::smaller:
        return hardened(model, from, values);
      case FormEdge::plainer:
        return straightened(model, from, values);
      case FormEdge::further:
        return softer_or_tilted(model, from, values);
    }
    return {};
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const std::string length = model.scene->capture.units.length;
    const std::string unit = model.scene->capture.units.stress() + "/" + length;
    const auto form = plane_form(ingredient.variant());
    if (!form)
      return fmt::format("the body touches a {} (contact stiffness {} {})", ingredient.variant(),
                         figure(values[0]), unit);
    const Plane plane = form->plane(values);
    const double gap = plane.out.dot(plane.through) - reach(*model.scene, plane.out);
    const std::string side = form->tilts
                                 ? fmt::format("its side towards {}", vector_text(plane.out))
                                 : fmt::format("its {} side", kSides[form->side]);
    const std::string place =
        form->tilts ? ", around " + place_text(plane.through, body_size(*model.scene).size) : "";
    return fmt::format(
        "the body touches a {} on {}, {} {} from where it ends at rest{}{}",
        form->hard ? "plane" : "cushion", side, figure(gap), length, place,
        form->hard ? "" : fmt::format(" (stiffness {} {})", figure(values[1]), unit));
  }

 private:
  std::vector<NextForm> freed_planes(const Model& model, const Ingredient& scored,
                                     const VectorXd& values) const {
    const auto plane = scored_plane(scored.variant());
    if (!plane) return {};
    // Tilt is freed where the score asks for it: free at an axis as well, a cushion at the body's
    // end imitates softening and outruns it. Frames are laid along tables and walls: what is next
    // to an axis of the frame starts as normal to it.
    for (int side = 0; side < 6; ++side)
      if (plane->out.dot(outward(side)) > std::cos(kLeaning)) {
        const double position = pressed(model, *plane).dot(outward(side));
        return {
            {refitted(model, {false, false, side, outward(side)}),
             Eigen::Vector2d(plane->out == outward(side) ? plane->position : position, values[0])}};
      }
    const Vector3d out = rounded(plane->out, 1.0);
    return {{refitted(model, {false, true, -1, out, pressed(model, *plane)}),
             Eigen::Vector4d(plane->position, values[0], 0.0, 0.0)}};
  }

  std::vector<NextForm> hardened(const Model& model, const Ingredient& cushion,
                                 const VectorXd& values) const {
    auto form = plane_form(cushion.variant());
    if (!form || form->hard) return {};
    form->hard = true;
    VectorXd start(form->tilts ? 3 : 1);
    start << values[0], values.tail(start.size() - 1);
    return {{refitted(model, *form), std::move(start)}};
  }

  std::vector<NextForm> straightened(const Model& model, const Ingredient& tilted,
                                     const VectorXd& values) const {
    const auto form = plane_form(tilted.variant());
    if (!form || !form->tilts) return {};
    const Plane plane = form->plane(values);
    for (int side = 0; side < 6; ++side) {
      if (plane.out.dot(outward(side)) < std::cos(kHalfStep)) continue;
      VectorXd start = values.head(values.size() - 2);
      start[0] = plane.through.dot(outward(side));
      return {{refitted(model, {form->hard, false, side, outward(side), Vector3d::Zero(),
                                form->stiffness}),
               std::move(start)}};
    }
    return {};
  }

  /// A cushion as stiff as the hard plane is, and free: a corner sinks into what is hard to a face.
  /// A plane that stood normal to an axis, tilting about where it is pressed: one up to half a step
  /// of the grid off looks like that.
  std::vector<NextForm> softer_or_tilted(const Model& model, const Ingredient& narrow,
                                         const VectorXd& values) const {
    const auto form = plane_form(narrow.variant());
    if (!form) return {};
    std::vector<NextForm> all;
    if (form->hard) {
      PlaneForm cushion = *form;
      cushion.hard = false, cushion.stiffness = 0.0;
      VectorXd start(values.size() + 1);
      start << values[0], form->stiffness, values.tail(values.size() - 1);
      all.push_back({refitted(model, cushion), start});
    }
    if (form->tilts) return all;
    const auto tilting = [&](PlaneForm other, double position) {
      other.tilts = true, other.side = -1, other.out = rounded(other.out, 1.0);
      other.about = pressed(model, {other.out, position, ""});
      return other;
    };
    VectorXd start(values.size() + 2);
    start << values, 0.0, 0.0;
    all.push_back({refitted(model, tilting(*form, values[0])), start});
    // What one straight plane presses from the end of the body a tilted one may from its middle: a
    // hard one goes there from where the nearest of the scores stands, by way of a softer one.
    const double size = body_size(*model.scene).size;
    const double near = reach(*model.scene, form->out) + kGaps[0] * size;
    if (std::abs(values[0] - near) > kGaps[0] * size) {
      PlaneForm plane = tilting({.hard = true, .out = form->out}, near);
      const auto hard = refitted(model, plane);
      plane.stiffness = rounded(hard_stiffness(model) / kSofter);
      all.push_back({hard, Vector3d(near, 0.0, 0.0), refitted(model, plane)});
    }
    return all;
  }

  std::shared_ptr<const Ingredient> soft(const Model& model, const ScoredPlane& scored) const {
    const double k = soft_stiffness(model);
    const Units& units = model.scene->capture.units;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = scored.text;
    spec.parameters = {{"floor_contact.k", units.stress() + "/" + units.length, "contact stiffness",
                        0.0, 0.0, 1e5 * k, k, false}};
    spec.touches = {.loading = true};
    const Plane plane{scored.out, scored.position * scored.out};
    spec.apply = [plane](const VectorXd& k, Model& m) { stand(m, plane, k[0]); };
    spec.derivative = [plane](const VectorXd&, const Model& m, int, const Equilibrium& equilibrium,
                              int, MechanicsDerivative& out) {
      Loading alone;  // linear in k
      alone.forces.push_back(force_of(m, plane, 1.0));
      out.dR_dt = residual(m.scene->body->mesh, EnergyModel{}, alone, equilibrium.q);
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  /// A plane that tilts may pass a fifth of the size inside the outermost point: as far as one
  /// through the middle of a face does that is half a step of the grid off.
  static Parameter position(const Scene& scene, const PlaneForm& form) {
    const double size = body_size(scene).size, rest = reach(scene, form.out.normalized());
    return {"floor_contact.position",
            scene.capture.units.length,
            fmt::format("where the plane stands along {}",
                        form.tilts ? digits(form.out) : kSides[form.side]),
            rest + 0.05 * size,
            rest - (form.tilts ? 0.2 : 0.02) * size,
            rest + size,
            0.01 * size,
            false};
  }

  std::shared_ptr<const Ingredient> refitted(const Model& model, PlaneForm form) const {
    const Scene& scene = *model.scene;
    const Units& units = scene.capture.units;
    const double k = soft_stiffness(model);
    if (form.hard && form.stiffness <= 0.0) form.stiffness = rounded(hard_stiffness(model));
    IngredientSpec spec;
    spec.name = name();
    spec.variant = form.variant();
    spec.has_null = false;
    spec.parameters = {position(scene, form)};
    if (!form.hard)
      spec.parameters.push_back({"floor_contact.k", units.stress() + "/" + units.length,
                                 "contact stiffness", k, 1e-4 * k, 1e5 * k, k, true});
    for (int i = 0; form.tilts && i < 2; ++i) {
      const auto axes = normal_axes(form.out);
      spec.parameters.push_back(
          {fmt::format("floor_contact.tilt{}", i + 1), "rad",
           fmt::format("turn of the plane about {}", vector_text(i ? axes.second : axes.first)),
           0.0, -0.8, 0.8, 0.05, false});
    }
    spec.touches = {.loading = true};
    spec.apply = [form](const VectorXd& values, Model& m) {
      stand(m, form.plane(values), form.hard ? form.stiffness : values[1]);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(floor_contact, FloorContact)
