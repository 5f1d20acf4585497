#include "estimation/inspection/first_guess.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>
#include <utility>

#include "simulation/equilibrium.h"

namespace hookeye::inspection {

namespace {

int corners(const TetMesh& mesh) {
  const auto block = mesh.elements.topRows<4>();
  return static_cast<int>(std::set<int>(block.reshaped().begin(), block.reshaped().end()).size());
}

/// Edges across the body: of a sheet, twice its volume over its surface is its thickness.
double elements_across(const TetMesh& mesh) {
  double area = 0.0;
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    const Vector3d a = mesh.X.col(mesh.boundary(0, f)), b = mesh.X.col(mesh.boundary(1, f)),
                   c = mesh.X.col(mesh.boundary(2, f));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  const MeshQuality q = quality(mesh);
  return area > 0.0 && q.mean_edge > 0.0 ? 2.0 * q.volume / area / q.mean_edge : 0.0;
}

/// The same on quadratic tetrahedra, at most `most` nodes of them; null: not to be had.
std::shared_ptr<const Scene> quadratic_scene(const Scene& scene, int most) {
  constexpr int kTries = 4;
  if (scene.body->mesh.order == 2 && scene.body->mesh.nodes() <= most)
    return scene.shared_from_this();
  double coarser = 1.0;
  for (int i = 0; i < kTries; ++i) {
    if (coarser > 1.0 && scene.capture.body.surface.empty()) break;
    auto out = remeshed(scene, coarser, 2, false);
    if (out->body->mesh.nodes() <= most) return out;
    // Nodes of a sheet go with the square of the edge.
    coarser *= 1.05 * std::sqrt(double(out->body->mesh.nodes()) / most);
  }
  return nullptr;
}

/// The scene on linear tetrahedra, at most `most` nodes of them; null: not to be had.
std::shared_ptr<const Scene> linear_scene(const Scene& scene, int most, std::string* refused) {
  const TetMesh& told = scene.body->mesh;
  const int nodes = corners(told);
  const bool has_surface = !scene.capture.body.surface.empty();
  if (told.order == 1 && nodes <= most) return scene.shared_from_this();
  try {
    const double coarser = nodes <= most ? 1.0 : std::cbrt(double(nodes) / most);
    if (coarser == 1.0 || has_surface) {
      auto coarse = remeshed(scene, coarser, 1, false);
      if (coarse->body->mesh.nodes() <= 2 * most) return coarse;
    }
  } catch (const InputError& error) {
    *refused = error.wrong();
    return nullptr;
  }
  *refused = fmt::format("the mesh has {} corners, too many for a quick solve", nodes);
  return nullptr;
}

std::shared_ptr<const Scene> coarse_scene(const Scene& scene, const InspectionOptions& options,
                                          std::string* refused) {
  auto linear = linear_scene(scene, options.coarse_nodes, refused);
  if (!linear || elements_across(linear->body->mesh) >= options.across_thin) return linear;
  try {
    if (auto quadratic = quadratic_scene(scene, options.coarse_nodes)) return quadratic;
  } catch (const InputError&) {  // the linear one is better than none
  }
  return linear;
}

/// Largest |sym grad u|, of the tetrahedra's corners.
double largest_strain(const TetMesh& mesh, const Eigen::Ref<const VectorXd>& u) {
  double largest = 0.0;
  for (int e = 0; e < mesh.size(); ++e) {
    Matrix3d X, x;
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.elements(k + 1, e), b = mesh.elements(0, e);
      X.col(k) = mesh.X.col(a) - mesh.X.col(b);
      x.col(k) = u.segment<3>(3 * a) - u.segment<3>(3 * b);
    }
    const Matrix3d gradient = x * X.inverse();
    largest = std::max(largest, (0.5 * (gradient + gradient.transpose())).norm());
  }
  return largest;
}

}  // namespace

CoarseModel::CoarseModel(const Scene& scene, const InspectionOptions& options) : options_(options) {
  scene_ = coarse_scene(scene, options, &refused_);
  if (!scene_) return;
  const ModelForm form = base_form(scene_);
  model_ = form.realise(form.initial());
}

CoarseModel::CoarseModel(std::shared_ptr<const Scene> scene, const InspectionOptions& options)
    : options_(options), scene_(std::move(scene)) {
  const ModelForm form = base_form(scene_);
  model_ = form.realise(form.initial());
}

CoarseModel::~CoarseModel() = default;

FirstGuess CoarseModel::to_first_order(int e, const Loading& loading) const {
  FirstGuess guess;
  const Body& body = *scene_->body;
  const TetMesh& mesh = body.mesh;
  const bool driven = !loading.forces.empty() || !loading.displacement.isZero(0.0);
  if (!driven) {
    guess.linear = Matrix3Xd::Zero(3, body.surface.mesh.X.cols());
    guess.u = guess.reaction = VectorXd::Zero(mesh.X.size());
    return guess;
  }
  const auto free = free_rigid_motions(mesh, loading);
  if (!free.empty()) {
    guess.failure = "nothing holds the body";
    return guess;
  }
  Loading still = loading;
  still.forces.clear();
  still.displacement.setZero();
  const EnergyModel energy = model_.energy_of(e);
  const auto at_rest = solve_equilibrium(mesh, energy, still);
  if (const auto* failure = std::get_if<NumericalFailure>(&at_rest)) {
    guess.failure = failure->reason;
    return guess;
  }
  const auto& rest = std::get<Equilibrium>(at_rest);
  const VectorXd X = mesh.X.reshaped();
  const VectorXd out_of_balance = residual(mesh, energy, loading, X);
  guess.u =
      sensitivities(rest, loading, out_of_balance, Eigen::MatrixXd(loading.displacement)).col(0);
  guess.reaction = out_of_balance + rest.K * guess.u;
  guess.strain = largest_strain(mesh, guess.u);
  guess.turned = loading.first_step() < 1.0;
  guess.linear = body.surface.deformed(mesh, X + guess.u) - body.surface.mesh.X;
  return guess;
}

void CoarseModel::find_equilibrium(int e, FirstGuess* guess) const {
  const TetMesh& mesh = scene_->body->mesh;
  if (guess->linear.size() == 0) return;
  if (guess->linear.isZero(0.0)) {
    guess->x = scene_->body->surface.mesh.X;
    guess->q = mesh.X.reshaped();
    guess->R = guess->reaction;
    return;
  }
  if (guess->strain > options_.most_strain && !guess->turned) {
    guess->failure = fmt::format("strained by {:.3g} to first order", guess->strain);
    return;
  }
  EquilibriumOptions options;
  options.tolerance = 1e-5;  // a picture shows a hundredth of a pixel, no more
  options.factored = false;
  options.most_iterations = options_.coarse_iterations;
  auto solved = solve_equilibrium(mesh, model_.energy_of(e),
                                  model_.examples[static_cast<size_t>(e)].loading, options);
  if (const auto* failure = std::get_if<NumericalFailure>(&solved)) {
    guess->failure = failure->reason;
    return;
  }
  auto& found = std::get<Equilibrium>(solved);
  guess->q = std::move(found.q), guess->R = std::move(found.R);
  guess->x = scene_->body->surface.deformed(mesh, guess->q);
}

std::vector<FirstGuess> CoarseModel::solve(bool in_equilibrium) const {
  std::vector<FirstGuess> all(model_.examples.size());
  tbb::parallel_for(size_t{0}, all.size(), [&](size_t e) {
    all[e] = to_first_order(static_cast<int>(e), model_.examples[e].loading);
    if (in_equilibrium) find_equilibrium(static_cast<int>(e), &all[e]);
  });
  return all;
}

FirstGuess CoarseModel::answer(int e, const Loading& loading) const {
  return to_first_order(e, loading);
}

}  // namespace hookeye::inspection
