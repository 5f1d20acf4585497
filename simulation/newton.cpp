#include "simulation/newton.h"

#include <fmt/format.h>

#include <cmath>

#include "meshing/extent.h"
#include "simulation/krylov.h"

namespace hookeye {
namespace {

/// Conjugate gradients dearer than this many solves lose against a factorization.
constexpr int kMaxCg = 15;
/// Below this error the tangent changes little from one iteration to the next.
constexpr double kNear = 0.3;
/// A decade by steps on an old factor, a solve and a residual each, takes as long as by conjugate
/// gradients on it, with a new tangent every two or three decades, where a step leaves this of the
/// error (a tangent takes five solves or residuals; gradients converge with the root).
constexpr double kChord = 0.3;

struct LineSearch {
  double step = 0.0;
  VectorXd q, R;
  int inverted_element = -1;  ///< the one that limited the step, -1: none
};

/// Longest of 1, 1/2, 1/4 ... that inverts nothing and either lowers the potential (Armijo) or
/// shrinks the slope along the direction (Bonet and Wood, 9.6.2), which also serves loads without
/// a potential and differences below rounding.
LineSearch search(const Problem& problem, double s, const VectorXd& q, const VectorXd& R,
                  const VectorXd& d, bool use_potential) {
  LineSearch out;
  const double slope = R.dot(d);
  double start = 0;
  if (use_potential) start = problem.potential(q, s);
  double step = 1.0;
  for (int i = 0; i < 24; ++i, step *= 0.5) {
    out.q = q + step * d;
    int element = -1;
    if (!(problem.assembly.smallest_J(out.q, &element) > 0)) {
      out.inverted_element = element;
      continue;
    }
    out.R = problem.residual(out.q, s);
    if (!out.R.allFinite()) continue;
    bool good = std::abs(out.R.dot(d)) <= 0.8 * std::abs(slope);
    if (use_potential) {
      const double now = problem.potential(out.q, s);
      const double rounding = 1e-13 * (std::abs(now) + std::abs(start));
      good = now <= start + 1e-4 * step * slope || (good && now <= start + rounding);
    }
    if (good) {
      out.step = step;
      return out;
    }
  }
  return out;
}

/// K_ff x = b with the true tangent on the factor at hand, of whichever tangent. -1: not reached,
/// or a new tangent's is had for less.
int solve_iteratively(const NewtonState& state, const VectorXd& b, double tolerance,
                      int max_iterations, VectorXd& x) {
  if (state.W_ff.nonZeros() == 0 && state.factor->iterates()) return -1;
  if (state.W_ff.nonZeros() == 0)
    return conjugate_gradients(state.K, *state.factor, b, tolerance, max_iterations, x);
  return gmres(sum(state.K, state.W), *state.factor, b, tolerance, max_iterations, x);
}

/// A descent direction from the true tangent (unless `project` says that it will be indefinite),
/// else from the projected one, else from that with a growing shift. False: nothing factorizes.
/// `forcing`: what iterations leave of b.
bool direction_by_factor(const Problem& problem, const NewtonGoal& goal, NewtonState& state,
                         const VectorXd& q, const VectorXd& b, double forcing, bool& project,
                         VectorXd& x) {
  const auto solved = [&](double shift) {
    return state.factorize(shift, false) && state.factor->solve_within(b, forcing, x);
  };
  if (!project && solved(0.0)) return x.allFinite();
  project = true;
  problem.tangent(q, goal.s, true, state.K);
  double shift = 0;
  const double diagonal = state.K.diagonal().cwiseAbs().mean();
  for (int i = 0; i < 12; ++i) {
    if (solved(shift)) return x.allFinite();
    shift = shift == 0 ? 1e-6 * diagonal : 10 * shift;
  }
  return false;
}

}  // namespace

std::shared_ptr<const SymbolicFactor> SymbolicFactors::of(const SparseMatrix& K,
                                                          const std::vector<int>& free) {
  const std::lock_guard lock(mutex_);
  std::erase_if(known_, [](const auto& factor) { return factor.expired(); });
  std::shared_ptr<const SymbolicFactor> found;
  for (const auto& factor : known_)
    if (const auto alive = factor.lock(); alive && alive->fits(K, free)) found = alive;
  if (!found) {
    found = std::make_shared<const SymbolicFactor>(K, free, ends_);
    known_.push_back(found);
  }
  std::erase(last_, found);
  last_.push_back(found);
  if (last_.size() > 2) last_.erase(last_.begin());
  return found;
}

void NewtonState::set_tangent(const Problem& problem, const VectorXd& q, double s) {
  problem.tangent(q, s, false, K);
  at = q;
  stiffest = K.diagonal().cwiseAbs().maxCoeff();
  W = problem.skew_tangent(q, s);
  W_ff = free_block(W, free);
}

bool NewtonState::factorize(double shift, bool surely) {
  if (!symbolic || !symbolic->fits(K, free)) {
    symbolic = shared ? shared->of(K, free) : std::make_shared<const SymbolicFactor>(K, free);
    factor.reset();
  }
  if (!factor || factor->symbolic() != symbolic)
    factor = std::make_shared<TangentFactor>(symbolic);
  else if (factor.use_count() > 1)
    factor = factor->another();
  ++factorizations;
  return factor->factorize(K, shift, at, surely);
}

double relative_error(const Problem& problem, const NewtonState& state, const VectorXd& R,
                      const VectorXd& q, double s) {
  const VectorXd f = problem.external(q, s);
  double largest = f.cwiseAbs().maxCoeff();
  for (int u : problem.loading.prescribed) largest = std::max(largest, std::abs(R[u]));
  largest = std::max(largest, 1e-5 * extent(problem.mesh.X) * state.stiffest);
  double error = 0;
  for (int u : state.free) {
    if (!std::isfinite(R[u])) return std::numeric_limits<double>::infinity();
    error = std::max(error, std::abs(R[u]));
  }
  return largest > 0 ? error / largest : error;
}

namespace {

/// Steps on the factor at hand for as long as they serve, within the tolerance at most: q, R and
/// `error` are of the best then. Not where the tangent has a skew part, which a factor lacks.
void step_on_factor(const Problem& problem, const NewtonGoal& goal, NewtonState& state, VectorXd& q,
                    VectorXd& R, double& error) {
  if (state.W_ff.nonZeros() != 0) return;
  VectorXd x;
  for (int i = 0; i < goal.max_iterations && error > goal.tolerance; ++i) {
    if (goal.cancelled && goal.cancelled()) return;
    ++state.iterations;
    if (!state.factor->solve_within(-select(R, state.free), 0.1 * kChord, x)) return;
    VectorXd there = q + spread(x, state.free, q.size());
    if (!(problem.assembly.smallest_J(there) > 0)) return;
    VectorXd R_there = problem.residual(there, goal.s);
    const double now = relative_error(problem, state, R_there, there, goal.s);
    if (!(now < error)) return;
    const bool serves = now <= kChord * error;
    q = std::move(there), R = std::move(R_there), error = now;
    if (!serves) return;
  }
}

}  // namespace

NewtonOutcome newton(const Problem& problem, const NewtonGoal& goal, NewtonState& state,
                     VectorXd& q) {
  NewtonOutcome out;
  const bool use_potential = problem.has_potential();
  const bool factored = state.factor && state.factor->positive();
  bool reuse = false;
  bool projected = false;
  VectorXd R = problem.residual(q, goal.s);
  double last_error = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= goal.max_iterations; ++i) {
    if (goal.cancelled && goal.cancelled())
      return {false, last_error, "cancelled", NumericalFailure::Kind::cancelled};
    if (i == 0 && factored) {
      out.error = relative_error(problem, state, R, q, goal.s);
      if (std::isfinite(out.error) && (goal.reuse_factor || out.error < kNear))
        step_on_factor(problem, goal, state, q, R, out.error);
      if (out.error <= goal.tolerance && !goal.tangent_there) {
        out.converged = true;
        return out;
      }
    }
    state.set_tangent(problem, q, goal.s);
    out.error = relative_error(problem, state, R, q, goal.s);
    if (out.error <= goal.tolerance) {
      out.converged = true;
      return out;
    }
    if (!std::isfinite(out.error)) return {false, out.error, "the residual is not finite"};
    if (i == goal.max_iterations) break;
    if (i == 0) reuse = factored && (goal.reuse_factor || out.error < kNear);
    ++state.iterations;
    const VectorXd b = -select(R, state.free);
    VectorXd x;
    // Forcing term: what quadratic convergence can use (Eisenstat and Walker 1996), and no more
    // than the last step needs.
    const double forcing =
        std::clamp(std::max(0.01 * out.error, 0.05 * goal.tolerance / out.error), 1e-7, 1e-2);
    const bool iterated = reuse && state.symbolic->fits(state.K, state.free) &&
                          solve_iteratively(state, b, forcing, kMaxCg, x) > 0;
    if (!iterated) {
      // Far from the solution an indefinite tangent is followed by others.
      projected = projected && out.error > kNear;
      if (!direction_by_factor(problem, goal, state, q, b, forcing, projected, x))
        return {false, out.error, "the tangent is singular: something is not held"};
    }
    reuse = (iterated || !projected) && (iterated || out.error < kNear);
    LineSearch found =
        search(problem, goal.s, q, R, spread(x, state.free, q.size()), use_potential);
    if (found.step == 0) {
      if (out.error <= 100 * goal.tolerance && out.error <= 1e-7) {  // rounding stops it
        out.converged = out.error <= 10 * goal.tolerance;
        if (out.converged) return out;
      }
      out.reason = found.inverted_element >= 0
                       ? fmt::format("every step inverts element {}", found.inverted_element)
                       : "no step along Newton's direction lowers the potential";
      return out;
    }
    q = std::move(found.q);
    R = std::move(found.R);
    last_error = out.error;
  }
  out.reason =
      fmt::format("no equilibrium after {} Newton iterations, residual {:.1e} of the largest force",
                  goal.max_iterations, out.error);
  return out;
}

}  // namespace hookeye
