#include "estimation/effects/graded_stiffness.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "estimation/effects/places.h"

namespace hookeye {

namespace {

const char* const kGradient = "free gradient";
const char* const kLayers = "free layers across";
const char* const kBall = "free ball";
/// Divisions of an element's edges whose nodes stand for its inside.
const int kDivisions = 4;

/// Barycentric, 4 x n.
Eigen::Matrix4Xd points_inside() {
  std::vector<Eigen::Vector4d> all;
  for (int i = 0; i <= kDivisions; ++i)
    for (int j = 0; i + j <= kDivisions; ++j)
      for (int k = 0; i + j + k <= kDivisions; ++k)
        all.emplace_back(i, j, k, kDivisions - i - j - k);
  Eigen::Matrix4Xd out(4, all.size());
  for (size_t i = 0; i < all.size(); ++i) out.col(i) = (all[i].array() + 0.25) / (kDivisions + 1.0);
  return out;
}

/// u + bend u^2, u = g.(X - centre) / size at the element centroids; values g, bend.
VectorXd gradient_field(const Scene& scene, const VectorXd& values) {
  const BodySize body = body_size(scene);
  const Vector3d g = values.head(3);
  const VectorXd u =
      (element_centres(scene.body->mesh).colwise() - body.centre).transpose() * g / body.size;
  return u.array() * (1.0 + values[3] * u.array());
}

/// Log of the mean over every element of exp(a s), s = 1 / (1 + exp(-t)) rising from 0 to 1 where
/// t(X) passes 0.
template <class Through>
VectorXd stepped(const TetMesh& mesh, double a, const Through& t) {
  static const Eigen::Matrix4Xd inside = points_inside();
  VectorXd log_factor(mesh.size());
  for (int e = 0; e < mesh.size(); ++e) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int k = 0; k < 4; ++k) corners.col(k) = mesh.X.col(mesh.elements(k, e));
    double sum = 0.0;
    for (Eigen::Index i = 0; i < inside.cols(); ++i)
      sum += std::exp(a / (1.0 + std::exp(-t(Vector3d(corners * inside.col(i))))));
    log_factor[e] = std::log(sum / static_cast<double>(inside.cols()));
  }
  return log_factor;
}

/// Beyond a plane; values a, angle1, angle2, offset, thickness.
VectorXd layers_field(const Scene& scene, const Vector3d& across, const VectorXd& values) {
  const Vector3d centre = body_size(scene).centre;
  const auto [first, second] = normal_axes(across);
  const Vector3d n = rotation_of(values[1] * first + values[2] * second) * across.normalized();
  return stepped(scene.body->mesh, values[0],
                 [&](const Vector3d& X) { return (n.dot(X - centre) - values[3]) / values[4]; });
}

std::shared_ptr<const Ingredient> gradient() {
  IngredientSpec spec;
  spec.name = "stiffness_field";
  spec.variant = kGradient;
  for (char axis : {'x', 'y', 'z'})
    spec.parameters.push_back(
        {fmt::format("stiffness_field.g{}", axis), "",
         fmt::format("log of the stiffness over the body's size along {}", axis), 0.0, -10.0, 10.0,
         0.5, false});
  spec.parameters.push_back(
      {"stiffness_field.bend", "", "bend of that logarithm", 0.0, -2.0, 2.0, 0.3, false});
  spec.touches = {.energy = true};
  spec.apply = [](const VectorXd& v, Model& m) {
    if (!v.head(3).isZero(0.0)) scale_energy(m, gradient_field(*m.scene, v));
  };
  return make_ingredient(std::move(spec));
}

std::shared_ptr<const Ingredient> layers(const Model& model, const Vector3d& across) {
  const BodySize body = body_size(*model.scene);
  const std::string length = model.scene->capture.units.length;
  IngredientSpec spec;
  spec.name = "stiffness_field";
  spec.variant = fmt::format("{} {}", kLayers, vector_text(across, 3));
  spec.parameters = {
      {"stiffness_field.a", "", "log of the stiffness factor", 0.0, -4.0, 4.0, 0.3, false},
      {"stiffness_field.angle1", "rad", "first angle of the plane", 0.0, -3.2, 3.2, 0.2, false},
      {"stiffness_field.angle2", "rad", "second angle of the plane", 0.0, -3.2, 3.2, 0.2, false},
      {"stiffness_field.offset", length, "place of the plane from the body's middle", 0.0,
       -0.5 * body.size, 0.5 * body.size, 0.1 * body.size, false},
      edge_thickness(model)};
  spec.touches = {.energy = true};
  spec.apply = [across](const VectorXd& v, Model& m) {
    if (v[0] != 0.0) scale_energy(m, layers_field(*m.scene, across, v));
  };
  return make_ingredient(std::move(spec));
}

std::shared_ptr<const Ingredient> ball(const Model& model, int place) {
  IngredientSpec spec;
  spec.name = "stiffness_field";
  spec.variant = as_place(kBall, place);
  spec.parameters = free_place(model);
  spec.parameters.push_back(edge_thickness(model));
  spec.parameters = of_place(std::move(spec.parameters), place);
  spec.touches = {.energy = true};
  spec.apply = [](const VectorXd& v, Model& m) {
    if (v[0] != 0.0) scale_energy(m, ball_field(*m.scene, v));
  };
  return make_ingredient(std::move(spec));
}

/// Mean slope of `field` by X, as volumes count.
Vector3d slope_of(const TetMesh& mesh, const VectorXd& field) {
  const VectorXd w = element_volumes(mesh) / element_volumes(mesh).sum();
  const Matrix3Xd X = element_centres(mesh);
  const Matrix3Xd off = X.colwise() - Vector3d(X * w);
  const Eigen::Matrix3d spread = off * w.asDiagonal() * off.transpose();
  return spread.inverse() * (off * w.asDiagonal() * field);
}

/// The plane t = offset that parts `field` best in two means, and how far they are apart.
struct Split {
  double offset = 0.0, step = 0.0;
};
Split best_split(const VectorXd& t, const VectorXd& field, const VectorXd& volume) {
  std::vector<int> order(static_cast<size_t>(t.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return t[a] < t[b]; });
  const double all = volume.sum(), sum = volume.dot(field);
  double below = 0.0, sum_below = 0.0, most = -1.0;
  Split best;
  for (size_t i = 0; i + 1 < order.size(); ++i) {
    below += volume[order[i]], sum_below += volume[order[i]] * field[order[i]];
    const double step = (sum - sum_below) / (all - below) - sum_below / below;
    const double between = below * (all - below) * step * step;
    if (between <= most) continue;
    most = between;
    best = {0.5 * (t[order[i]] + t[order[i + 1]]), step};
  }
  return best;
}

}  // namespace

void scale_energy(Model& model, const VectorXd& log_factor) {
  const VectorXd factor = log_factor.array().exp();
  for (auto& part : model.energy.parts)
    part.weight = part.weight.size() == 0 ? factor : VectorXd(part.weight.cwiseProduct(factor));
}

Parameter edge_thickness(const Model& model) {
  const double size = body_size(*model.scene).size;
  return {"stiffness_field.thickness",
          model.scene->capture.units.length,
          "length over which the stiffness changes",
          0.05 * size,
          0.01 * size,
          size,
          0.05 * size,
          true};
}

VectorXd ball_field(const Scene& scene, const VectorXd& values) {
  const Vector3d centre = values.segment<3>(1);
  return stepped(scene.body->mesh, values[0],
                 [&](const Vector3d& X) { return (values[4] - (X - centre).norm()) / values[5]; });
}

std::vector<Parameter> free_place(const Model& model) {
  const BodySize body = body_size(*model.scene);
  const std::string length = model.scene->capture.units.length;
  std::vector<Parameter> all = {
      {"stiffness_field.a", "", "log of the stiffness factor", 0.0, -4.0, 4.0, 0.3, false}};
  for (int i = 0; i < 3; ++i)
    all.push_back({fmt::format("stiffness_field.{}", "xyz"[i]), length,
                   fmt::format("centre of the place, {}", "xyz"[i]), body.centre[i], body.low[i],
                   body.high[i], 0.1 * body.size, false});
  all.push_back({"stiffness_field.radius", length, "radius of the place", 0.12 * body.size,
                 0.02 * body.size, body.size, 0.1 * body.size, true});
  return all;
}

bool is_graded(const std::string& variant) {
  return variant == kGradient || place_variant(variant).form == kBall ||
         starts_with(variant, kLayers);
}

std::shared_ptr<const Ingredient> graded_form(const Model& model, const std::string& variant) {
  if (variant == kGradient) return gradient();
  if (const auto [form, place] = place_variant(variant); form == kBall) return ball(model, place);
  const auto n = numbers_in(variant);
  if (!starts_with(variant, kLayers) || n.size() != 3) return nullptr;
  return layers(model, Vector3d(n[0], n[1], n[2]));
}

std::vector<NextForm> further_grades(const Model& model, const VectorXd& log_factor) {
  const Scene& scene = *model.scene;
  const TetMesh& mesh = scene.body->mesh;
  const BodySize body = body_size(scene);
  const Vector3d slope = slope_of(mesh, log_factor);
  const Vector3d across = slope.norm() > 0.0 ? rounded(slope.normalized(), 1.0) : Vector3d::UnitZ();
  const VectorXd t = (element_centres(mesh).colwise() - body.centre).transpose() * across;
  const Split split = best_split(t / across.norm(), log_factor, element_volumes(mesh));
  VectorXd in_layers(5);
  in_layers << split.step, 0.0, 0.0, split.offset, 0.05 * body.size;
  const Vector3d g = slope * body.size;
  return {{gradient(), Eigen::Vector4d(g.x(), g.y(), g.z(), 0.0)},
          {layers(model, across), in_layers}};
}

NextForm layers_like(const Model& model, const Vector3d& across, double a) {
  VectorXd values(5);
  values << a, 0.0, 0.0, 0.0, 0.05 * body_size(*model.scene).size;
  return {.form = layers(model, across), .values = values};
}

NextForm ball_like(const Model& model, const VectorXd& blob, int place) {
  VectorXd values(6);
  values << blob[0] / std::sqrt(8.0), blob.segment<3>(1),
      std::cbrt(6.0 * std::sqrt(EIGEN_PI)) * blob[4], 0.0;
  values[5] = 0.1 * values[4];
  return {.form = ball(model, place), .values = values, .same_claim = true};
}

std::string graded_sentence(const Model& model, const Ingredient& ingredient,
                            const VectorXd& values) {
  const std::string length = model.scene->capture.units.length;
  if (ingredient.variant() == kGradient) {
    const VectorXd field = gradient_field(*model.scene, values).array().exp();
    const Vector3d g = values.head(3);
    return fmt::format("stiffness changes along {} by factors from {} to {}",
                       vector_text(g.norm() > 0.0 ? Vector3d(g.normalized()) : g),
                       figure(field.minCoeff()), figure(field.maxCoeff()));
  }
  if (place_variant(ingredient.variant()).form == kBall)
    return fmt::format("a ball {} times as stiff as the rest, of radius {} {} around {}",
                       figure(std::exp(values[0])), figure(values[4]), length,
                       place_text(values.segment<3>(1), body_size(*model.scene).size));
  const auto n = numbers_in(ingredient.variant());
  const Vector3d across(n.at(0), n.at(1), n.at(2));
  const auto [first, second] = normal_axes(across);
  const Vector3d normal = rotation_of(values[1] * first + values[2] * second) * across.normalized();
  const BodySize body = body_size(*model.scene);
  return fmt::format(
      "two layers: {} times as stiff beyond the plane through {} {} across {} as before it",
      figure(std::exp(values[0])), place_text(body.centre + values[3] * normal, body.size), length,
      vector_text(normal));
}

}  // namespace hookeye
