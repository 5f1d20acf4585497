#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// Sum of the dead forces of an example [force].
Vector3d resultant(const ExampleSpec& example) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& load : example.loads)
    if (load.force) sum += *load.force;
  return sum;
}

/// Largest dead force where they cancel in sum.
Vector3d leading_force(const ExampleSpec& example) {
  Vector3d largest = resultant(example);
  for (const auto& load : example.loads)
    if (load.force && load.force->norm() > 1.001 * largest.norm()) largest = *load.force;
  return largest;
}

/// Adds what turning the dead forces of an example changes.
void tilt(Model& model, int example, const Vector3d& rotation_vector) {
  const Scene& scene = *model.scene;
  const Eigen::Matrix3d change = rotation_of(rotation_vector) - Eigen::Matrix3d::Identity();
  for (const auto& load : scene.capture.examples[example].loads)
    if (load.force)
      model.examples[example].loading.forces.push_back(
          dead_force(scene.body->regions.at(load.region), change * *load.force));
}

/// The dead forces point elsewhere than told, by a rotation about axes normal to them.
class LoadDirection final : public Effect {
 public:
  std::string name() const override { return "load_direction"; }
  EffectGroup group() const override { return EffectGroup::loads; }
  std::string title() const override { return "misaligned load"; }
  bool several() const override { return true; }
  std::string manual() const override {
    return "The force of one example, or of all, points a few degrees away from where it was "
           "told, at its told size. Easily taken for anisotropy, a soft clamp or a set-up placed "
           "wrongly; in one example alone it predicts nothing about the others.";
  }

  Ingredients candidates(const Model& model, std::string* why_not) const override {
    const auto& examples = model.scene->capture.examples;
    std::vector<int> loaded;
    Ingredients all;
    for (size_t e = 0; e < examples.size(); ++e) {
      if (leading_force(examples[e]).isZero(0.0)) continue;
      loaded.push_back(static_cast<int>(e));
      if (examples[e].validate) continue;
      const auto [first, second] = normal_axes(leading_force(examples[e]));
      all.push_back(turn("in " + examples[e].name, {static_cast<int>(e)}, {first, second}));
    }
    if (all.empty() && why_not) *why_not = "no dead force is told in a fitted example";
    if (!all.empty() && loaded.size() > 1)
      all.push_back(turn("in all", loaded, common_axes(model, loaded)));
    return all;
  }

  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    const auto& examples = model.scene->capture.examples;
    const std::vector<int> loaded = turned_examples(model, ingredient.variant());
    if (loaded.empty()) return "the load is misaligned";
    const Vector3d force = leading_force(examples[loaded.front()]);
    const auto axes = axes_of(model, loaded, ingredient.variant());
    const Vector3d w = turn_about(axes, values);
    const Vector3d now = rotation_of(w) * force;
    const double angle = std::atan2(force.cross(now).norm(), force.dot(now));
    if (ingredient.variant() == "in all")
      return fmt::format("all loads are turned by {} degrees about {}",
                         figure(w.norm() * 180.0 / EIGEN_PI),
                         vector_text(w.norm() > 0 ? Vector3d(w.normalized()) : w));
    return fmt::format("the load of '{}' is {} degrees off and points towards {}",
                       examples[loaded.front()].name, figure(angle * 180.0 / EIGEN_PI),
                       vector_text(now.normalized()));
  }

  /// The same turn from the other side. A slender body bends under what pushes it sideways and
  /// hardly gives along its length: of a load that points far from where it was told a refit
  /// settles the part across, and may keep the part along with the wrong sign.
  std::vector<NextForm> forms_from(FormEdge edge, const Model& model, const Ingredient& from,
                                   const VectorXd& values) const override {
    if (edge != FormEdge::further) return {};
    const auto loaded = turned_examples(model, from.variant());
    auto form = candidate(model, from.variant());
    if (loaded.empty() || !form) return {};
    const auto axes = axes_of(model, loaded, from.variant());
    if (axes.size() != 2) return {};
    const Vector3d told = leading_force(model.scene->capture.examples[loaded.front()]);
    const Vector3d now = rotation_of(turn_about(axes, values)) * told;
    const Vector3d along = long_axis(*model.scene);
    const Vector3d mirrored = now - 2.0 * along.dot(now) * along;
    const Eigen::AngleAxisd turn(Eigen::Quaterniond::FromTwoVectors(told, mirrored));
    VectorXd start(2);
    for (int i = 0; i < 2; ++i) {
      start[i] = turn.angle() * turn.axis().dot(axes[i]);
      if (std::abs(start[i]) > kMostTurn) return {};
    }
    return {{std::move(form), std::move(start)}};
  }

 private:
  static constexpr double kMostTurn = 1.6;  ///< about one axis [rad]

  /// The direction in which the body is longest: of its elements' centres, by volume.
  static Vector3d long_axis(const Scene& scene) {
    const Matrix3Xd X = element_centres(scene.body->mesh);
    const VectorXd V = element_volumes(scene.body->mesh);
    const Vector3d centre = X * V / V.sum();
    const Matrix3Xd from_centre = X.colwise() - centre;
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(from_centre * V.asDiagonal() *
                                                          from_centre.transpose())
        .eigenvectors()
        .col(2);
  }

  /// The examples whose loads a variant turns.
  static std::vector<int> turned_examples(const Model& model, const std::string& variant) {
    const auto& examples = model.scene->capture.examples;
    std::vector<int> turned;
    for (size_t e = 0; e < examples.size(); ++e)
      if (!leading_force(examples[e]).isZero(0.0) &&
          (variant == "in all" || variant == "in " + examples[e].name))
        turned.push_back(static_cast<int>(e));
    return turned;
  }

  static std::vector<Vector3d> axes_of(const Model& model, const std::vector<int>& turned,
                                       const std::string& variant) {
    if (variant == "in all") return common_axes(model, turned);
    const auto [first, second] =
        normal_axes(leading_force(model.scene->capture.examples[turned.front()]));
    return {first, second};
  }

  static Vector3d turn_about(const std::vector<Vector3d>& axes, const VectorXd& angles) {
    Vector3d w = Vector3d::Zero();
    for (size_t i = 0; i < axes.size(); ++i) w += angles[i] * axes[i];
    return w;
  }

  /// Two axes where all forces are parallel (a turn about them changes nothing), else three.
  static std::vector<Vector3d> common_axes(const Model& model, const std::vector<int>& loaded) {
    const auto& examples = model.scene->capture.examples;
    const Vector3d first = leading_force(examples[loaded.front()]).normalized();
    for (int e : loaded)
      if (first.cross(leading_force(examples[e]).normalized()).norm() > 0.02)
        return {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    const auto [a, b] = normal_axes(first);
    return {a, b};
  }

  std::shared_ptr<const Ingredient> turn(const std::string& variant, std::vector<int> examples,
                                         std::vector<Vector3d> axes) const {
    IngredientSpec spec;
    spec.name = name();
    spec.variant = variant;
    for (size_t i = 0; i < axes.size(); ++i)
      spec.parameters.push_back({fmt::format("load_direction.{}.angle{}", variant.substr(3), i + 1),
                                 "rad",
                                 fmt::format("turn of the load about {}", vector_text(axes[i])),
                                 0.0, -kMostTurn, kMostTurn, 0.05, false});
    spec.touches = {.loading = true};
    spec.apply = [examples, axes](const VectorXd& values, Model& m) {
      const Vector3d w = turn_about(axes, values);
      for (int e : examples) tilt(m, e, w);
    };
    return make_ingredient(std::move(spec));
  }
};

}  // namespace

}  // namespace hookeye

HOOKEYE_DEFINE_EFFECT(load_direction, LoadDirection)
