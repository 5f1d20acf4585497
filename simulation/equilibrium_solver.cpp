#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

#include "core/work_clock.h"
#include "simulation/no_memory.h"
#include "simulation/of_mesh.h"
#include "simulation/rigid_modes.h"

namespace hookeye {

struct EquilibriumSolver::Impl {
  std::shared_ptr<const TetMesh> mesh;
  std::shared_ptr<OfMesh> shared;
  Assembly& assembly;
  NewtonState state;
  VectorXd q;  ///< last solution; empty: none
  VectorXd rest;

  explicit Impl(std::shared_ptr<const TetMesh> m)
      : mesh(std::move(m)),
        shared(of_mesh(mesh)),
        assembly(shared->assembly),
        rest(mesh->X.reshaped()) {
    state.shared = shared->symbolic;
  }

  VectorXd moved_along(const Problem& problem, const VectorXd& x) const;
  double out_of_balance(const Problem& problem, const VectorXd& x) const;
  bool warm(const Problem& problem, const EquilibriumOptions& options, VectorXd& x);
  bool in_equilibrium(const Problem& problem, const EquilibriumOptions& options, const VectorXd& x,
                      const VectorXd& R) const;
  NewtonOutcome climb(const Problem& problem, const EquilibriumOptions& options, VectorXd& x,
                      double& reached);
  Result<Equilibrium> finish(const Problem& problem, bool factored, VectorXd x);
  Result<Equilibrium> solve(const Problem& problem, const EquilibriumOptions& options,
                            const VectorXd* start);
  void forget();
};

namespace {

/// Jump of the prescribed unknowns from q to their place at load fraction s, 3n, zero elsewhere.
/// The way there is straight; from rest it goes round as supports turn.
VectorXd prescribed_jump(const Problem& problem, const VectorXd& rest, const VectorXd& from,
                         const VectorXd& q, double s) {
  VectorXd jump = VectorXd::Zero(q.size());
  const auto& loading = problem.loading;
  const bool round = !loading.turns.empty() && s < 1.0 && from == rest;
  for (size_t i = 0; i < loading.prescribed.size(); ++i) {
    const int u = loading.prescribed[i];
    const double target = rest[u] + loading.displacement[static_cast<Eigen::Index>(i)];
    jump[u] = round ? rest[u] + loading.displacement_at(problem.mesh.X, i, s) - q[u]
                    : from[u] + s * (target - from[u]) - q[u];
  }
  return jump;
}

/// What iterations may leave of a predicted motion, which is that of a linear body.
constexpr double kPredicted = 1e-3;

/// Motion of all unknowns when the prescribed ones jump and the load grows: the jump, and on the
/// free ones -K_ff^-1 (R(s_new) + K_fc jump) with the factor at hand.
VectorXd predict(const Problem& problem, const NewtonState& state, const SparseMatrix& K,
                 const VectorXd& q, double s, const VectorXd& jump) {
  const VectorXd R = problem.residual(q, s) + K * jump;
  VectorXd x;
  if (!state.factor->solve_within(-select(R, state.free), kPredicted, x))
    state.factor->solve(-select(R, state.free), x);
  VectorXd d = jump;
  for (size_t i = 0; i < state.free.size(); ++i) d[state.free[i]] = x[static_cast<Eigen::Index>(i)];
  return d;
}

/// Largest of 1, 1/2 ... of the step that keeps every det F above a tenth of what it was.
double feasible(const Assembly& assembly, const VectorXd& q, const VectorXd& d, double least) {
  const double floor = 0.1 * std::min(1.0, assembly.smallest_J(q));
  for (double t = 1.0; t >= least; t *= 0.5)
    if (assembly.smallest_J(q + t * d) > floor) return t;
  return 0.0;
}

/// A way from where the body was that is not found within these is sought from rest instead: near
/// an obstacle that has moved a few steps of a few iterations lead to it.
constexpr int kHeldIterations = 30;
constexpr double kShortestHeld = 0.01;

/// " (most compressed: element 12, det F 0.1)"
std::string most_compressed(const Assembly& assembly, const VectorXd& x) {
  int element = -1;
  const double J = assembly.smallest_J(x, &element);
  return fmt::format(" (most compressed: element {}, det F {:.3g})", element, J);
}

NewtonOutcome failed(std::string reason) { return {false, 0.0, std::move(reason)}; }

/// `most`: of this load step; what is left of the iterations of all of them may be less.
NewtonGoal goal_of(const EquilibriumOptions& options, const NewtonState& state, double s,
                   int most) {
  NewtonGoal goal;
  goal.s = s;
  goal.tolerance = options.tolerance;
  goal.tangent_there = options.factored;
  goal.max_iterations =
      std::min({options.max_iterations, most, options.most_iterations - state.iterations});
  goal.cancelled = options.cancelled;
  return goal;
}

/// Unknowns to hold besides the prescribed ones where supports leave rigid motions free and the
/// loads do not drive them (any placement is an equilibrium: one is chosen). Nothing where forces
/// with a stiffness may hold the body. Sets `fault` when the loads do drive a free motion.
std::vector<int> pins_of(const Problem& problem, const VectorXd& rest, std::string& fault) {
  for (const auto& f : problem.loading.forces)
    if (!f->dead()) return {};
  const RigidModes modes(problem.mesh);
  const MatrixXd free = modes.free(problem.loading.prescribed);
  if (free.cols() == 0) return {};
  if (modes.imbalance(free, problem.external(rest, 1.0)) > 1e-9) {
    fault = fmt::format("nothing holds the body against {}",
                        fmt::join(free_rigid_motions(problem.mesh, problem.loading), ", "));
    return {};
  }
  return modes.pins(free);
}

}  // namespace

/// x with the supports where they belong and the interior moved along with them, by the last
/// factor. Without such a move it stays.
VectorXd EquilibriumSolver::Impl::moved_along(const Problem& problem, const VectorXd& x) const {
  const VectorXd jump = prescribed_jump(problem, rest, x, x, 1.0);
  if (jump.isZero(0.0)) return x;
  SparseMatrix K;
  problem.tangent(x, 1.0, false, K);
  return x + predict(problem, state, K, x, 1.0, jump);
}

/// |R_free|, infinite where an element is inverted.
double EquilibriumSolver::Impl::out_of_balance(const Problem& problem, const VectorXd& x) const {
  if (!(assembly.smallest_J(x) > 0)) return std::numeric_limits<double>::infinity();
  return select(problem.residual(x, 1.0), state.free).norm();
}

/// From the last solution straight to the full load, with the last factor as long as it serves.
bool EquilibriumSolver::Impl::warm(const Problem& problem, const EquilibriumOptions& options,
                                   VectorXd& x) {
  if (!state.factor || !state.factor->positive()) return false;
  VectorXd trial = moved_along(problem, x);
  if (options.expected) {
    VectorXd expected = moved_along(problem, *options.expected);
    if (out_of_balance(problem, expected) < out_of_balance(problem, trial))
      trial = std::move(expected);
  }
  if (!(assembly.smallest_J(trial) > 0)) return false;
  NewtonGoal goal = goal_of(options, state, 1.0, 25);
  goal.reuse_factor = true;
  if (!newton(problem, goal, state, trial).converged) return false;
  x = std::move(trial);
  return true;
}

/// x is where all loads keep it: nothing needs a factor to find that out. R: residual() there.
bool EquilibriumSolver::Impl::in_equilibrium(const Problem& problem,
                                             const EquilibriumOptions& options, const VectorXd& x,
                                             const VectorXd& R) const {
  return prescribed_jump(problem, rest, x, x, 1.0).isZero(0.0) &&
         relative_error(problem, state, R, x, 1.0) <= options.tolerance;
}

/// Adaptive load steps from x with the supports at x. From rest the loads grow; from elsewhere all
/// of them are there, and a force fades that holds x. (It would hold a body that has swollen at its
/// rest size, too, but dead forces that squeeze a soft body do not hold it stably.) Intermediate
/// states are only converged loosely.
NewtonOutcome EquilibriumSolver::Impl::climb(const Problem& at_once,
                                             const EquilibriumOptions& options, VectorXd& x,
                                             double& reached) {
  const VectorXd from = x;
  const VectorXd out_of_balance = at_once.residual(x, 1.0);
  Problem problem = at_once;
  EquilibriumOptions own = options;
  if (x != rest) {
    problem.held_by = &out_of_balance;
    own.most_iterations = std::min(own.most_iterations, state.iterations + kHeldIterations);
    own.smallest_step = std::max(own.smallest_step, kShortestHeld);
  }
  NewtonOutcome out;
  // One step of half a turn would lead straight through the axis, and one of a whole turn nowhere.
  const double first = x == rest ? problem.loading.first_step() : 1.0;
  double s = 0, step = first;
  while (s < 1) {
    if (state.iterations >= own.most_iterations)
      return failed(fmt::format("no equilibrium within {} Newton iterations", state.iterations));
    step = std::min({step, 2.0 * first, 1 - s});
    const double next = step >= 1 - s - 1e-12 ? 1.0 : s + step;
    state.set_tangent(problem, x, s);
    const bool wound = from == rest && problem.loading.winds();
    if (s == 0 && !wound && in_equilibrium(at_once, options, x, out_of_balance)) {
      if (options.factored) state.set_tangent(at_once, x, 1.0);
      reached = 1.0;
      return {true, 0.0, ""};
    }
    if (!state.factorize(0.0, true)) {
      if (problem.held_by) return failed("held where it was, the body is not stable");
      problem.tangent(x, s, true, state.K);
      if (!state.factorize(0.0, true))
        return failed("the tangent is singular: something is not held");
    }
    const VectorXd jump = prescribed_jump(problem, rest, from, x, next);
    const VectorXd d = predict(problem, state, state.K, x, next, jump);
    const double t = feasible(assembly, x, d, own.smallest_step / std::max(step, 1e-12));
    if (t < 1) {
      // The predictor is linear in the load: a part of it belongs to that part of the load.
      out.reason = "the next load step would invert an element";
      step *= t > 0 ? t : 0.25;
    } else {
      VectorXd trial = x + d;
      NewtonGoal goal = goal_of(own, state, next, next < 1 ? 15 : own.max_iterations);
      if (next < 1) goal.tolerance = std::max(goal.tolerance, 1e-3), goal.tangent_there = false;
      out = newton(problem, goal, state, trial);
      if (out.kind == NumericalFailure::Kind::cancelled) return out;
      if (out.converged) {
        x = std::move(trial);
        reached = s = next;
        step *= 2;
        continue;
      }
      step *= 0.4;
    }
    if (step < own.smallest_step) return failed(out.reason + most_compressed(assembly, x));
  }
  return out;
}

Result<Equilibrium> EquilibriumSolver::Impl::finish(const Problem& problem, bool factored,
                                                    VectorXd x) {
  Equilibrium e;
  e.R = problem.residual(x, 1.0);
  if (factored) {
    e.stable = state.factorize(0.0, true);  // newton() left the true tangent at x in K
    if (!e.stable && !state.factor->factorize_indefinite(state.K))
      return no_result(
          {problem.loading.name, 1.0,
           "the tangent at the solution is singular: the body buckles here or is not held"});
    e.factor = state.factor;
    if (state.W.nonZeros() != 0) state.K = sum(state.K, state.W);
    e.K = std::move(state.K);
    e.W_ff = state.W_ff;
  }
  state.K = {};  // as large as half a factor, and there is one of these an example
  for (int u : state.free) e.R[u] = 0;
  e.newton_iterations = state.iterations;
  e.factorizations = state.factorizations;
  q = x;
  e.q = std::move(x);
  return e;
}

Result<Equilibrium> EquilibriumSolver::Impl::solve(const Problem& problem,
                                                   const EquilibriumOptions& options,
                                                   const VectorXd* start) {
  std::string fault;
  const std::vector<int> pins = pins_of(problem, rest, fault);
  if (!fault.empty()) return no_result({problem.loading.name, 0.0, fault});
  std::vector<int> free = problem.free_unknowns();
  std::erase_if(free, [&](int u) { return std::binary_search(pins.begin(), pins.end(), u); });
  if (free != state.free) {
    state.free = std::move(free);
    state.symbolic.reset();
    state.factor.reset();
  }
  state.iterations = state.factorizations = 0;
  VectorXd x = q.size() ? q : start ? *start : rest;
  if (!q.size() && start && options.expected &&
      out_of_balance(problem, *options.expected) < out_of_balance(problem, x))
    x = *options.expected;
  if (q.size() && warm(problem, options, x)) return finish(problem, options.factored, std::move(x));

  NumericalFailure failure{problem.loading.name, 0.0, ""};
  EquilibriumOptions own = options;
  for (int attempt = 0; attempt < 2; ++attempt) {
    double reached = 0;
    const bool from_rest = attempt == 1 || (!q.size() && !start);
    if (from_rest) x = rest;
    const int before = state.iterations;
    const NewtonOutcome out = climb(problem, own, x, reached);
    if (out.converged) return finish(problem, options.factored, std::move(x));
    failure.load_fraction = reached;
    failure.reason = out.reason;
    failure.kind = out.kind;
    if (from_rest || cancelled(failure)) break;
    // What the way from elsewhere took is not taken from the one that has always been there.
    if (own.most_iterations < std::numeric_limits<int>::max() - state.iterations)
      own.most_iterations += state.iterations - before;
    if (state.iterations >= own.most_iterations) break;
  }
  return no_result(std::move(failure));
}

void EquilibriumSolver::Impl::forget() {
  q.resize(0);
  state.factor.reset();
}

EquilibriumSolver::EquilibriumSolver(std::shared_ptr<const TetMesh> mesh)
    : impl_(std::make_unique<Impl>(std::move(mesh))) {}
EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

void EquilibriumSolver::forget() { impl_->forget(); }

Result<Equilibrium> EquilibriumSolver::solve(const EnergyModel& energy, const Loading& loading,
                                             const EquilibriumOptions& options,
                                             const VectorXd* start) {
  const Working part(WorkPart::equilibria);
  const Problem problem{*impl_->mesh, impl_->assembly, energy, loading};
  try {
    return impl_->solve(problem, options, start);
  } catch (const std::bad_alloc& error) {
    impl_->forget();
    impl_->state.K = {};
    return no_result(no_memory(*impl_->mesh, loading, error, impl_->state.symbolic.get()));
  }
}

Result<Equilibrium> solve_equilibrium(const TetMesh& mesh, const EnergyModel& energy,
                                      const Loading& loading, const EquilibriumOptions& options) {
  // Not owned: the solver does not outlive this call.
  EquilibriumSolver solver(std::shared_ptr<const TetMesh>(std::shared_ptr<void>(), &mesh));
  return solver.solve(energy, loading, options);
}

}  // namespace hookeye
