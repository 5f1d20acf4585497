#include "estimation/inspection/first_guess.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <utility>

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

/// Load cases in an order that is theirs and not the file's: from the one that moves least, each is
/// followed by the nearest of those that are left. Nearness is that of the first-order motions of
/// some nodes, spread over the mesh; names decide where two are alike.
std::vector<size_t> by_nearness(const std::vector<FirstGuess>& guesses,
                                const std::vector<ExampleSpec>& examples) {
  constexpr Eigen::Index kNodes = 64;
  std::vector<size_t> left;
  for (size_t e = 0; e < guesses.size(); ++e)
    if (guesses[e].u.size() > 0) left.push_back(e);
  std::sort(left.begin(), left.end(),
            [&](size_t a, size_t b) { return examples[a].name < examples[b].name; });
  std::vector<VectorXd> sketch(guesses.size());
  for (const size_t e : left) {
    const Eigen::Index nodes = guesses[e].u.size() / 3, some = std::min(kNodes, nodes);
    sketch[e].resize(3 * some);
    for (Eigen::Index i = 0; i < some; ++i)
      sketch[e].segment<3>(3 * i) = guesses[e].u.segment<3>(3 * (i * nodes / some));
  }
  std::vector<size_t> order;
  while (!left.empty()) {
    const auto far = [&](size_t e) {
      return order.empty() ? sketch[e].squaredNorm()
                           : (sketch[e] - sketch[order.back()]).squaredNorm();
    };
    // The first of several that are as near: they lie in the order of their names.
    auto next = left.begin();
    double least = far(*next);
    for (auto one = next + 1; one != left.end(); ++one)
      if (const double distance = far(*one); distance < least) least = distance, next = one;
    order.push_back(*next);
    left.erase(next);
  }
  return order;
}

/// Something acts on the body.
bool moves(const Loading& loading) {
  return !loading.forces.empty() || !loading.displacement.isZero(0.0);
}

}  // namespace

CoarseModel::CoarseModel(const Scene& scene, const InspectionOptions& options) : options_(options) {
  scene_ = coarse_scene(scene, options, &refused_);
  if (!scene_) return;
  const ModelForm form = base_form(scene_);
  model_ = form.realise(form.initial());
  of_mesh_ = std::make_unique<EquilibriumSolver>(scene_->mesh());
}

CoarseModel::CoarseModel(std::shared_ptr<const Scene> scene, const InspectionOptions& options)
    : options_(options), scene_(std::move(scene)) {
  const ModelForm form = base_form(scene_);
  model_ = form.realise(form.initial());
  of_mesh_ = std::make_unique<EquilibriumSolver>(scene_->mesh());
}

CoarseModel::~CoarseModel() = default;

CoarseModel::Held CoarseModel::held(int e, const Loading& loading) const {
  return {loading.prescribed, model_.examples[static_cast<size_t>(e)].stiffness};
}

CoarseModel::AtRest CoarseModel::at_rest(int e, const Loading& loading) const {
  const Held held = this->held(e, loading);
  {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(held);
    if (found != known_.end()) return found->second;
  }
  Loading still = loading;
  still.forces.clear();
  still.displacement.setZero();
  still.turns.clear();
  auto solved = EquilibriumSolver(scene_->mesh()).solve(model_.energy_of(e), still);
  AtRest out;
  out.one_at_a_time = std::make_shared<std::mutex>();
  if (!solved)
    out.why = solved.error().reason;
  else
    out.state = std::make_shared<const Equilibrium>(*std::move(solved));
  const std::lock_guard lock(mutex_);
  if (known_.size() < kMostKept) known_.emplace(held, out);
  return out;
}

/// What load cases share, before all of them ask for it at once.
void CoarseModel::keep_at_rest() const {
  std::map<Held, int> first;
  for (size_t e = 0; e < model_.examples.size() && first.size() < kMostKept; ++e) {
    const Loading& loading = model_.examples[e].loading;
    if (moves(loading)) first.emplace(held(static_cast<int>(e), loading), static_cast<int>(e));
  }
  std::vector<int> examples;
  for (const auto& [held, e] : first) examples.push_back(e);
  tbb::parallel_for(size_t{0}, examples.size(), [&](size_t i) {
    at_rest(examples[i], model_.examples[static_cast<size_t>(examples[i])].loading);
  });
}

FirstGuess CoarseModel::to_first_order(int e, const Loading& loading) const {
  FirstGuess guess;
  const Body& body = *scene_->body;
  const TetMesh& mesh = body.mesh;
  if (!moves(loading)) {
    guess.linear = Matrix3Xd::Zero(3, body.surface.mesh.X.cols());
    guess.u = guess.reaction = VectorXd::Zero(mesh.X.size());
    return guess;
  }
  const auto free = free_rigid_motions(mesh, loading);
  if (!free.empty()) {
    guess.failure = "nothing holds the body";
    return guess;
  }
  const AtRest rest = at_rest(e, loading);
  if (!rest.state) {
    guess.failure = rest.why;
    return guess;
  }
  const VectorXd X = mesh.X.reshaped();
  const VectorXd out_of_balance = residual(mesh, model_.energy_of(e), loading, X);
  {
    const std::lock_guard lock(*rest.one_at_a_time);
    guess.u =
        sensitivities(*rest.state, loading, out_of_balance, Eigen::MatrixXd(loading.displacement))
            .col(0);
  }
  guess.reaction = out_of_balance + rest.state->K * guess.u;
  guess.strain = largest_strain(mesh, guess.u);
  guess.turned = loading.first_step() < 1.0;
  guess.linear = body.surface.deformed(mesh, X + guess.u) - body.surface.mesh.X;
  return guess;
}

/// False: it is known, or not to be had.
bool CoarseModel::needs_equilibrium(FirstGuess* guess) const {
  const TetMesh& mesh = scene_->body->mesh;
  if (guess->linear.size() == 0) return false;
  if (guess->linear.isZero(0.0)) {
    guess->x = scene_->body->surface.mesh.X;
    guess->q = mesh.X.reshaped();
    guess->R = guess->reaction;
    return false;
  }
  if (guess->strain > options_.most_strain && !guess->turned) {
    guess->failure = fmt::format("strained by {:.3g} to first order", guess->strain);
    return false;
  }
  return true;
}

/// Of these examples, one after the other: each begins where the one before ended, as load cases of
/// a series lie near one another, unless rest is as near.
void CoarseModel::find_equilibria(std::span<const size_t> examples,
                                  const std::function<void()>& done,
                                  std::vector<FirstGuess>* guesses) const {
  constexpr double kNear = 0.5;  // of the way from rest
  const TetMesh& mesh = scene_->body->mesh;
  EquilibriumSolver solver(scene_->mesh());
  const FirstGuess* before = nullptr;
  for (const size_t e : examples) {
    FirstGuess& guess = (*guesses)[e];
    done();
    if (!needs_equilibrium(&guess)) continue;
    const Loading& loading = model_.examples[e].loading;
    const bool near =
        before && loading.turns.empty() && (guess.u - before->u).norm() < kNear * guess.u.norm();
    VectorXd expected;
    EquilibriumOptions options;
    options.tolerance = 1e-5;  // a picture shows a hundredth of a pixel, no more
    options.factored = false;
    options.most_iterations = options_.coarse_iterations;
    if (near) {
      expected = before->q + (guess.u - before->u);
      options.expected = &expected;
    } else {
      solver.forget();
    }
    auto solved = solver.solve(model_.energy_of(static_cast<int>(e)), loading, options);
    before = nullptr;
    if (!solved) {
      guess.failure = solved.error().reason;
      solver.forget();
      continue;
    }
    auto& found = *solved;
    guess.q = std::move(found.q), guess.R = std::move(found.R);
    guess.x = scene_->body->surface.deformed(mesh, guess.q);
    if (loading.turns.empty()) before = &guess;
  }
}

std::vector<FirstGuess> CoarseModel::solve(
    const std::set<int>& nodes, const std::function<void(int done, int of)>& solved) const {
  // Of a few load cases each is found from rest, all at once.
  constexpr size_t kPieces = 16, kLongest = 16;
  const size_t count = model_.examples.size();
  std::vector<FirstGuess> all(count);
  const auto asked = [&](size_t e) { return nodes.count(static_cast<int>(e)) > 0; };
  keep_at_rest();
  tbb::parallel_for(size_t{0}, count, [&](size_t e) {
    all[e] = to_first_order(static_cast<int>(e), model_.examples[e].loading);
    if (!asked(e)) all[e].reaction = {};
  });
  const std::vector<size_t> order = by_nearness(all, scene_->capture.examples);
  const size_t length = std::clamp(count / kPieces, size_t{1}, kLongest);
  std::atomic<int> begun = 0;
  const auto one_more = [&] {
    if (solved) solved(++begun, static_cast<int>(order.size()));
  };
  tbb::parallel_for(size_t{0}, (order.size() + length - 1) / length, [&](size_t piece) {
    const size_t first = piece * length;
    const auto here = std::span(order).subspan(first, std::min(length, order.size() - first));
    find_equilibria(here, one_more, &all);
    for (const size_t e : here)
      if (!asked(e)) all[e].u = all[e].q = all[e].R = VectorXd();
  });
  return all;
}

FirstGuess CoarseModel::answer(int e, const Loading& loading) const {
  return to_first_order(e, loading);
}

}  // namespace hookeye::inspection
