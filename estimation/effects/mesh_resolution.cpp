#include <fmt/format.h>

#include <stdexcept>

#include "estimation/effects/other_mesh.h"
#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// `share` of the force, worked out when first asked for: a model that is only written costs
/// nothing.
class MeshError final : public ForceTerm {
 public:
  MeshError(std::shared_ptr<OtherMesh> other, int example, double share)
      : other_(std::move(other)), example_(example), share_(share) {}
  double potential(const TetMesh& mesh, const VectorXd& q, double s) const override {
    return term().potential(mesh, q, s);
  }
  void add_residual(const TetMesh& mesh, const VectorXd& q, double s, VectorXd& R) const override {
    term().add_residual(mesh, q, s, R);
  }
  void add_tangent(const TetMesh&, const VectorXd&, double, Triplets&) const override {}
  bool dead() const override { return true; }

 private:
  const ForceTerm& term() const {
    std::call_once(once_, [&] { term_ = nodal_force(share_ * other_->force(example_)); });
    return *term_;
  }
  std::shared_ptr<OtherMesh> other_;
  int example_;
  double share_;
  mutable std::once_flag once_;
  mutable std::shared_ptr<const ForceTerm> term_;
};

/// The tetrahedra are too coarse. Scored by what a finer mesh changes at the same parameters;
/// refitted on that mesh.
class MeshResolution final : public Effect {
 public:
  std::string name() const override { return "mesh_resolution"; }
  EffectGroup group() const override { return EffectGroup::numerical; }
  std::string title() const override { return "a mesh that is too coarse"; }
  std::string manual() const override {
    return "The tetrahedra are too large to bend and twist as the body does, so the model is too "
           "stiff, most where it is slender or clamped. Easily taken for stiffening, for a stiff "
           "place or for a wrong load; a finer mesh tells, which is why it is settled before a "
           "material is named. The refit is on that mesh, with a share of what it changed on top "
           "for what a still finer one would do; what changes the pictures by less than the next "
           "refinement would is not named on it.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const Capture& capture = model.scene->capture;
    const bool linear = model.scene->body->mesh.order == 1;
    std::string reason;
    for (const auto& [ingredient, values] : model.applied)
      if (ingredient->name() == name()) reason = "the mesh has been refined already";
    if (!linear && capture.body.surface.empty())
      reason = "the volume is told without a surface, so that it cannot be meshed anew";
    for (const auto& material : capture.materials)
      if (!linear && !material.region.empty() && !material.blend)
        reason = "the materials belong to groups of the told volume, which a new mesh has not";
    if (why_not && !reason.empty()) *why_not = reason;
    if (!reason.empty()) return {};
    return {estimate(model, linear ? kQuadratic : kByEdge)};
  }

  std::shared_ptr<const Ingredient> rebuild(const Model& model,
                                            const std::string& variant) const override {
    return remeshes(variant) ? refined(model, variant) : nullptr;
  }

  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd&) const override {
    const std::string change = "change by ";
    if (edge != FormEdge::refit || !starts_with(from.variant(), change)) return {};
    return {{refined(model, from.variant().substr(change.size())), VectorXd::Zero(1)}};
  }

  bool remeshes(const std::string& variant) const override {
    return variant == kQuadratic || variant == kByEdge;
  }

  std::shared_ptr<const Scene> refit_scene(const Scene& scene,
                                           const std::string& variant) const override {
    return variant == kQuadratic ? remeshed(scene, 1.0, 2, true)
                                 : remeshed(scene, kFinerEdge, 0, true);
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const std::string& variant = ingredient.variant();
    const std::string finer =
        variant.find(kQuadratic) != std::string::npos
            ? "quadratic tetrahedra in place of linear ones"
            : fmt::format("tetrahedra of {} times the edge (now {} {})", kFinerEdge,
                          figure(quality(model.scene->body->mesh).mean_edge),
                          model.scene->capture.units.length);
    if (remeshes(variant))
      return fmt::format("a finer mesh: {}, and {} times the change that it brought on top", finer,
                         figure(values[0]));
    return fmt::format("a finer mesh ({}), with {} times the change that it brings", finer,
                       figure(values[0]));
  }

 private:
  static constexpr const char* kByEdge = "edge times 0.7";
  static constexpr const char* kQuadratic = "order 2";

  std::shared_ptr<const Ingredient> estimate(const Model& model, const std::string& variant) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = "change by " + variant;
    // Errors fall at least in proportion to the edge: all of it is at most 1/(1 - 0.7) of the
    // change from one mesh to the other.
    spec.parameters = {{"mesh_resolution.s", "", "times the change that a finer mesh brings", 0.0,
                        0.0, 1.0 / (1.0 - kFinerEdge), 1.0, false}};
    spec.touches = {.loading = true};
    const auto finer = std::make_shared<OtherMesh>(model, variant == kQuadratic ? 1.0 : kFinerEdge,
                                                   variant == kQuadratic ? 2 : 0);
    spec.apply = [finer](const VectorXd& s, Model& m) {
      for (size_t e = 0; e < m.examples.size(); ++e)
        m.examples[e].loading.forces.push_back(
            std::make_shared<MeshError>(finer, static_cast<int>(e), s[0]));
    };
    spec.derivative = [finer](const VectorXd&, const Model& m, int example,
                              const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
      out.dR_dt.setZero(equilibrium.q.size());
      nodal_force(finer->force(example))
          ->add_residual(m.scene->body->mesh, equilibrium.q, 1.0, out.dR_dt);
      return true;
    };
    return make_ingredient(std::move(spec));
  }

  /// `model` lives on the finer mesh, but where the form is only asked for its parameters. What an
  /// infinitely fine one would change beyond it is a share of what it changed itself (Richardson
  /// 1911), which the photos fit: a real body has no mesh, and what the finer one still gets wrong
  /// would be blamed on a clamp or a stiff place.
  std::shared_ptr<const Ingredient> refined(const Model& model, const std::string& variant) const {
    // Falling in proportion to the edge is the slowest, and with its square the rule; quadratic
    // elements halve the error of linear ones at least, and leave a tenth of it as a rule.
    const bool quadratic = variant == kQuadratic;
    const double most = quadratic ? 1.0 : kFinerEdge / (1.0 - kFinerEdge);
    const double next = quadratic ? 0.1 : kFinerEdge * kFinerEdge;
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    spec.parameters = {{"mesh_resolution.s", "", "more of what the refinement changed", 0.0, 0.0,
                        most, next, false}};
    spec.touches = {.loading = true};
    const auto told = std::make_shared<OtherMesh>(model, 1.0, 0);
    spec.apply = [told, body = model.scene->body](const VectorXd& s, Model& m) {
      if (m.scene->body != body)
        throw std::logic_error("mesh_resolution: what a refinement changed is of another mesh");
      if (s[0] == 0.0) return;
      for (size_t e = 0; e < m.examples.size(); ++e)
        m.examples[e].loading.forces.push_back(
            std::make_shared<MeshError>(told, static_cast<int>(e), -s[0]));
    };
    spec.derivative = [told](const VectorXd&, const Model& m, int example,
                             const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
      out.dR_dt.setZero(equilibrium.q.size());
      nodal_force(-told->force(example))
          ->add_residual(m.scene->body->mesh, equilibrium.q, 1.0, out.dR_dt);
      return true;
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(mesh_resolution, MeshResolution)
