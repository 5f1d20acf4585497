#include "estimation/effects/stiffness_places.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>

#include "estimation/effects/graded_stiffness.h"
#include "estimation/effects/places.h"

namespace hookeye {

namespace {

using Eigen::MatrixXd;

constexpr Eigen::Index kPlacesTried = 1000;  ///< elements tried as the middle of a place, at most
const std::string kManyBlobs = "free blobs, ";
const std::string kManyBalls = "free balls, ";

/// How many places, and whether they are balls. 0: another variant.
struct Several {
  int count = 0;
  bool balls = false;
};
Several several_in(const std::string& variant) {
  const auto n = numbers_in(variant);
  if (n.size() != 1 || n[0] < 2.0 || n[0] > 9.0) return {};
  const int count = static_cast<int>(n[0]);
  if (variant == kManyBlobs + std::to_string(count)) return {count, false};
  if (variant == kManyBalls + std::to_string(count)) return {count, true};
  return {};
}

/// Values a, x, y, z, radius of place `k`, counted from 0.
auto place_values(const VectorXd& values, int k) { return values.segment<5>(5 * k); }

VectorXd places_field(const Scene& scene, const Several& form, const VectorXd& values) {
  VectorXd out = VectorXd::Zero(scene.body->mesh.size());
  for (int k = 0; k < form.count; ++k) {
    const VectorXd one = place_values(values, k);
    if (form.balls) {
      VectorXd ball(6);
      ball << one, values[5 * form.count];
      out += ball_field(scene, ball);
    } else {
      out += one[0] * gaussian_bump(scene.body->mesh, one.segment<3>(1), one[4]);
    }
  }
  return out;
}

std::shared_ptr<const Ingredient> places_of(const Model& model, const Several& form) {
  IngredientSpec spec;
  spec.name = "stiffness_field";
  spec.variant = (form.balls ? kManyBalls : kManyBlobs) + std::to_string(form.count);
  for (int k = 1; k <= form.count; ++k)
    for (Parameter& one : of_place(free_place(model), k)) spec.parameters.push_back(std::move(one));
  if (form.balls) spec.parameters.push_back(edge_thickness(model));
  spec.touches = {.energy = true};
  spec.apply = [form](const VectorXd& v, Model& m) {
    for (int k = 0; k < form.count; ++k)
      if (place_values(v, k)[0] != 0.0) return scale_energy(m, places_field(*m.scene, form, v));
  };
  return make_ingredient(std::move(spec));
}

}  // namespace

namespace {

/// A sum of bumps over the elements, each value times the root of the volume, and places that it
/// may be like, less what a constant and the same amplitude in all bumps say of them.
class FieldOfBumps {
 public:
  FieldOfBumps(const TetMesh& mesh, const std::vector<Vector3d>& centres, double radius,
               const VectorXd& values)
      : mesh_(mesh), w_(element_volumes(mesh).cwiseSqrt()), field_(VectorXd::Zero(mesh.size())) {
    MatrixXd rest = MatrixXd::Zero(mesh.size(), 2);
    rest.col(0) = w_;
    for (size_t i = 0; i < centres.size(); ++i) {
      const VectorXd one = bump({centres[i], radius});
      field_ += values[static_cast<Eigen::Index>(i)] * one;
      rest.col(1) += one;
    }
    Q_ = Eigen::HouseholderQR<MatrixXd>(rest).householderQ() * MatrixXd::Identity(mesh.size(), 2);
    field_ -= Q_ * (Q_.transpose() * field_);
  }
  /// Less the rest.
  const VectorXd& field() const { return field_; }
  /// Less the rest; nothing where hardly more is left of it, which says nothing.
  std::optional<VectorXd> place(const Blob& blob) const {
    const VectorXd one = bump(blob);
    VectorXd own = one - Q_ * (Q_.transpose() * one);
    if (own.squaredNorm() < 1e-3 * one.squaredNorm()) return {};
    return own;
  }

 private:
  VectorXd bump(const Blob& blob) const {
    return w_.cwiseProduct(gaussian_bump(mesh_, blob.centre, blob.radius));
  }

  const TetMesh& mesh_;
  VectorXd w_, field_;
  MatrixXd Q_;
};

/// Of places, the `count` that leave least of the field: all subsets are tried.
struct Subset {
  std::vector<Eigen::Index> members;
  VectorXd amplitudes;
  double takes = 0.0;
};
class SubsetSearch {
 public:
  /// Gram matrix of the places, their products with the field, and where each is.
  SubsetSearch(MatrixXd gram, VectorXd products, std::vector<size_t> where)
      : gram_(std::move(gram)), products_(std::move(products)), where_(std::move(where)) {}
  Subset best(int count) {
    best_ = {};
    chosen_.clear();
    choose(0, count);
    return best_;
  }

 private:
  void choose(Eigen::Index first, int more) {
    if (more == 0) return look();
    for (Eigen::Index i = first; i < gram_.cols(); ++i) {
      if (!chosen_.empty() && where_[static_cast<size_t>(chosen_.back())] == where_[i]) continue;
      chosen_.push_back(i);
      choose(i + 1, more - 1);
      chosen_.pop_back();
    }
  }
  void look() {
    const MatrixXd own = gram_(chosen_, chosen_);
    const Eigen::LDLT<MatrixXd> factor(own);
    // two that are hardly told apart say what one does
    if (factor.vectorD().minCoeff() < 1e-3 * own.diagonal().maxCoeff()) return;
    const VectorXd c = products_(chosen_), a = factor.solve(c);
    if (const double takes = a.dot(c); takes > best_.takes) best_ = {chosen_, a, takes};
  }

  MatrixXd gram_;
  VectorXd products_;
  std::vector<size_t> where_;
  std::vector<Eigen::Index> chosen_;
  Subset best_;
};

constexpr double kShares[] = {0.5, 0.7, 1.0, 1.4};  ///< of the bumps' radius

}  // namespace

std::pair<Blob, double> likest_place(const TetMesh& mesh, const std::vector<Vector3d>& centres,
                                     double radius, const VectorXd& values) {
  const FieldOfBumps bumps(mesh, centres, radius, values);
  std::vector<Vector3d> places = centres;
  const Matrix3Xd elements = element_centres(mesh);
  const Eigen::Index stride = (elements.cols() + kPlacesTried - 1) / kPlacesTried;
  for (Eigen::Index e = 0; e < elements.cols(); e += stride) places.emplace_back(elements.col(e));
  std::pair<Blob, double> likest{{centres.front(), radius}, 0.0};
  double most = 0.0;
  for (double share : kShares)
    for (const Vector3d& centre : places) {
      const Blob blob{centre, share * radius};
      const auto one = bumps.place(blob);
      if (!one) continue;
      const double along = one->dot(bumps.field()), square = one->squaredNorm();
      if (along * along <= most * square) continue;
      most = along * along / square;
      likest = {blob, along / square};
    }
  return likest;
}

std::vector<StiffPlaces> likest_places(const TetMesh& mesh, const std::vector<Vector3d>& centres,
                                       double radius, const VectorXd& values, int most) {
  const FieldOfBumps bumps(mesh, centres, radius, values);
  std::vector<Blob> blobs;
  std::vector<size_t> where;
  MatrixXd columns(mesh.size(), static_cast<Eigen::Index>(std::size(kShares) * centres.size()));
  for (size_t i = 0; i < centres.size(); ++i)
    for (double share : kShares)
      if (const auto one = bumps.place({centres[i], share * radius})) {
        columns.col(static_cast<Eigen::Index>(blobs.size())) = *one;
        blobs.push_back({centres[i], share * radius});
        where.push_back(i);
      }
  columns.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(blobs.size()));
  SubsetSearch subsets(columns.transpose() * columns, columns.transpose() * bumps.field(), where);
  const double all = bumps.field().squaredNorm();
  std::vector<StiffPlaces> out;
  for (int count = 1; count <= most; ++count) {
    const Subset best = subsets.best(count);
    if (best.members.empty()) break;
    StiffPlaces places;
    for (const Eigen::Index i : best.members) places.blobs.push_back(blobs[static_cast<size_t>(i)]);
    places.amplitudes = best.amplitudes;
    places.left = std::max(all - best.takes, 0.0) / all;
    out.push_back(std::move(places));
  }
  return out;
}

bool is_places(const std::string& variant) { return several_in(variant).count > 0; }

std::shared_ptr<const Ingredient> places_form(const Model& model, const std::string& variant) {
  const Several form = several_in(variant);
  return form.count > 0 ? places_of(model, form) : nullptr;
}

std::vector<NextForm> places_like(const Model& model, const std::vector<Vector3d>& centres,
                                  double radius, const VectorXd& values) {
  // a place has five numbers: more of them say no less than the bumps
  const int most = (static_cast<int>(centres.size()) - 1) / 5;
  std::vector<NextForm> out;
  for (const StiffPlaces& one :
       likest_places(model.scene->body->mesh, centres, radius, values, most)) {
    const auto count = static_cast<int>(one.blobs.size());
    if (count < 2) continue;
    VectorXd start(5 * count);
    for (int k = 0; k < count; ++k)
      start.segment<5>(5 * k) = freed(one.blobs[static_cast<size_t>(k)], one.amplitudes[k]);
    out.push_back({.form = places_of(model, {count, false}), .values = start, .same_claim = true});
  }
  return out;
}

std::optional<NextForm> balls_like(const Model& model, const Ingredient& blobs,
                                   const VectorXd& values) {
  const Several form = several_in(blobs.variant());
  if (form.count == 0 || form.balls) return {};
  VectorXd start(values.size() + 1);
  double thickness = 0.0;
  for (int k = 0; k < form.count; ++k) {
    const VectorXd ball = ball_like(model, place_values(values, k)).values;
    start.segment<5>(5 * k) = ball.head(5);
    thickness += ball[5] / form.count;
  }
  start[values.size()] = thickness;
  return NextForm{
      .form = places_of(model, {form.count, true}), .values = start, .same_claim = true};
}

std::string places_sentence(const Model& model, const Ingredient& ingredient,
                            const VectorXd& values) {
  const Several form = several_in(ingredient.variant());
  const double size = body_size(*model.scene).size;
  std::vector<std::string> all;
  for (int k = 0; k < form.count; ++k) {
    const VectorXd one = place_values(values, k);
    all.push_back(fmt::format("{} times as stiff around {}, of radius {}", figure(std::exp(one[0])),
                              place_text(one.segment<3>(1), size), figure(one[4])));
  }
  return fmt::format("{} {} in the body, against the rest: {} {}", form.count,
                     form.balls ? "balls" : "places", fmt::join(all, "; "),
                     model.scene->capture.units.length);
}

}  // namespace hookeye
