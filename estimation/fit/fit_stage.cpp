#include "estimation/fit/fit_stage.h"

#include <ceres/ceres.h>

#include <cmath>

#include "estimation/fit/convex_fit.h"
#include "estimation/fit/floor.h"
#include "estimation/model/additive_material.h"

namespace hookeye {

namespace {

class ReducedCost final : public ceres::CostFunction {
 public:
  ReducedCost(Workspace& workspace, const ModelForm& form, const FitScope& scope,
              const Scaling& scaling, EvaluationOptions options)
      : workspace_(workspace),
        form_(form),
        scope_(scope),
        scaling_(scaling),
        options_(std::move(options)) {
    for (const EnergyModel::Part& part : form.start.energy.parts)
      named_addends_ |= additive_model(*part.term) != nullptr;
    set_num_residuals(form.size() + 1);
    mutable_parameter_block_sizes()->push_back(form.size());
  }

  bool Evaluate(double const* const* x_, double* r, double** J) const override {
    const VectorXd x = Eigen::Map<const VectorXd>(x_[0], form_.size());
    // An accepted step is asked again for its Jacobian; both come from one evaluation.
    if (x.size() != cached_x_.size() || x != cached_x_) {
      const VectorXd p = scaling_.to_p(x);
      if (named_addends_) {
        const Model model = form_.realise(p);
        if ((failure_ = not_convex(model))) return false;
        smallest_eigenvalue_ = hookeye::smallest_eigenvalue(model)->smallest;
      }
      auto result = workspace_.evaluate(form_, p, options_);
      if (!result) {
        failure_ = result.error();
        return false;
      }
      const NormalEquations sums = scope_.of(*result);
      cached_ = condense(within_bounds(sums, scaling_, p), scaling_.dp_dx(p));
      cached_x_ = x;
    }
    Eigen::Map<VectorXd>(r, x.size()) = cached_.z;
    r[x.size()] = cached_.rho;
    if (J && J[0]) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor> jacobian(J[0], x.size() + 1, x.size());
      jacobian.topRows(x.size()) = cached_.R;
      jacobian.row(x.size()).setZero();
    }
    return true;
  }
  const std::optional<NumericalFailure>& failure() const { return failure_; }
  bool named_addends() const { return named_addends_; }
  /// Of named addends, where it was asked last.
  double smallest_eigenvalue() const { return smallest_eigenvalue_; }
  /// Fall of |r|^2 that the next Gauss-Newton step promises, and |r|^2 itself.
  double promised() const { return cached_.z.squaredNorm(); }
  double r2() const { return cached_.z.squaredNorm() + cached_.rho * cached_.rho; }

 private:
  Workspace& workspace_;
  const ModelForm& form_;
  const FitScope& scope_;
  const Scaling& scaling_;
  EvaluationOptions options_;
  bool named_addends_ = false;  ///< values of an additive law: steps must stay convex
  mutable VectorXd cached_x_;
  mutable CondensedResidual cached_;
  mutable double smallest_eigenvalue_ = std::numeric_limits<double>::quiet_NaN();
  mutable std::optional<NumericalFailure> failure_;
};

class Reporter final : public ceres::IterationCallback {
 public:
  Reporter(const FitOptions& options, const FitLimits& limits, const ReducedCost& cost, Stage stage,
           double count, double misfit, int of)
      : options_(options),
        limits_(limits),
        cost_(cost),
        stage_(stage),
        count_(count),
        misfit_(misfit),
        of_(of) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (options_.cancel && options_.cancel->load()) return ceres::SOLVER_ABORT;
    if (summary.iteration == 0 || summary.step_is_successful) {
      least_ = std::fmin(least_, cost_.smallest_eigenvalue());  // asked there for its Jacobian
      chi_ = chi(summary.cost);
      refused_ = 0;
    }
    if (done(summary)) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (options_.progress) options_.progress({stage_.name(), summary.iteration, of_, chi_});
    return ceres::SOLVER_CONTINUE;
  }
  double smallest_eigenvalue() const { return least_; }

 private:
  /// A promised fall of 0.01 moves the parameters by a tenth of their standard deviation under
  /// white noise; below 1e-6 of |r|^2 rays that change triangles hide it (two evaluations 1e-6
  /// apart in a modulus differ by some 1e-5), and at 1e-5 moduli stopped a standard error short. A
  /// refused step that changed next to nothing has met the same limit. A structured misfit moves
  /// the parameters by more than noise does: the limit grows with its square.
  bool done(const ceres::IterationSummary& summary) {
    // What `cost_` promises is of the point that it saw last: here, of the refused one.
    if (!summary.step_is_successful && summary.iteration > 0)
      return std::abs(summary.cost_change) < limits_.motion_step * summary.cost || gives_up();
    if (stage_.level > 1 && cost_.promised() < limits_.coarse_step * cost_.r2()) return true;
    // Some hundred effective residuals: 1e-4 of |r|^2 is about a tenth of a standard error.
    if (stage_.registered && cost_.promised() < limits_.motion_step * cost_.r2()) return true;
    if (summary.iteration == 0) return false;
    if (cost_.promised() <
        std::max(limits_.least_promise, limits_.tolerance * misfit_ * misfit_ * cost_.r2()))
      return true;
    return creeps(summary);
  }

  /// Two steps in a row that gained nothing that counts. Of a structured misfit, whose effective
  /// residuals are some hundred, 1e-3 of |r|^2 is a third of a standard error, whatever was
  /// promised: near a fold of the equilibria derivatives hold for tiny steps alone. Steps on the
  /// way to `aim_chi` count where twenty of them would arrive. (In coarse pictures chi is another.)
  bool creeps(const ceres::IterationSummary& summary) {
    const double chi = this->chi(summary.cost);
    const double structured = 1.0 - 1.0 / std::max(1.0, chi * chi);
    const double fell = this->chi(summary.cost + summary.cost_change) - chi;
    const double least = stage_.level > 1
                             ? limits_.coarse_step
                             : limits_.tolerance + limits_.motion_tolerance * structured;
    const bool counts = summary.cost_change > least * summary.cost;
    const bool arrives = options_.aim_chi == 0.0 || stage_.level > 0 ||
                         limits_.aim_steps * fell > chi - options_.aim_chi;
    slow_ = counts && arrives ? 0 : slow_ + 1;
    return slow_ == limits_.slow_steps;
  }
  /// Four refused steps in a row on the way to `aim_chi`. They shrink by 2, 4, 8, 16: where a
  /// thousandth of the step finds no equilibrium or nothing better, nobody arrives.
  bool gives_up() {
    return ++refused_ >= limits_.refused_steps && options_.aim_chi > 0.0 && chi_ > options_.aim_chi;
  }
  double chi(double cost) const { return std::sqrt(2.0 * cost / std::max(1.0, count_)); }

  const FitOptions& options_;
  const FitLimits& limits_;
  const ReducedCost& cost_;
  Stage stage_;
  double count_, misfit_;
  int of_;
  int slow_ = 0, refused_ = 0;                            ///< steps in a row
  double chi_ = std::numeric_limits<double>::infinity();  ///< after the last accepted step
  double least_ = std::numeric_limits<double>::quiet_NaN();
};

/// Pixels; of fields alone their numbers.
double count_of_seen(const Evaluation& evaluation) {
  const bool fields = evaluation.seen() == Evaluation::Seen::fields;
  double count = 0.0;
  for (const auto& example : evaluation.examples) {
    for (const auto& photo : example.photos) count += photo.count;
    for (const auto& measured : example.measured)
      if (fields && measured.is_field()) count += measured.size();
  }
  return count;
}

/// What `pictures` and, where none of them is at rest, the rest photos by themselves tell.
Result<double> weight_of_measured(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                                  const FitOptions& options, const Evaluation& pictures,
                                  int level) {
  const auto& examples = form.scene->capture.examples;
  const auto rests = [&](const auto& example) { return is_rest(examples[example.example]); };
  const auto measures = [](const auto& example) { return !example.measured.empty(); };
  if (std::none_of(pictures.examples.begin(), pictures.examples.end(), measures)) return 1.0;
  if (std::any_of(pictures.examples.begin(), pictures.examples.end(), rests))
    return measured_weight(*form.scene, pictures);
  EvaluationOptions at_rest = only_pictures(level, options);
  for (size_t e = 0; e < examples.size(); ++e)
    if (is_rest(examples[e])) at_rest.only.push_back(static_cast<int>(e));
  if (at_rest.only.empty()) return 1.0;
  auto seen = workspace.evaluate(form, p, at_rest);
  if (!seen) return failure_of(seen);
  return measured_weight(*form.scene, *seen);
}

}  // namespace

Result<Look> look(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                  const FitOptions& options, const FitScope& scope, int level) {
  EvaluationOptions pictures_alone = only_pictures(level, options);
  scope.choose(pictures_alone);
  auto seen = workspace.evaluate(form, p, pictures_alone);
  if (!seen) return failure_of(seen);
  const Evaluation& pictures = *seen;
  const auto weight = weight_of_measured(workspace, form, p, options, pictures, level);
  if (!weight) return failure_of(weight);
  return Look{misfit_scale(pictures), count_of_seen(pictures), pictures.motion_px(), *weight};
}

Result<StageResult> run_stage(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                              const FitOptions& options, const FitScope& scope, Stage stage,
                              const Look& seen) {
  const int level = stage.level;
  EvaluationOptions evaluation;
  scope.choose(evaluation);
  evaluation.level = level;
  evaluation.registered = stage.registered;
  evaluation.most_iterations = kStepIterations;
  evaluation.cancel = options.cancel;
  evaluation.huber = options.huber_times(*form.scene) * seen.misfit;
  evaluation.measured_weight = seen.measured_weight;

  const FitLimits& limits = form.scene->limits->fit;
  const Scaling scaling{form.parameters()};
  VectorXd x = scaling.to_x(start);
  ReducedCost cost(workspace, form, scope, scaling, evaluation);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(&cost, nullptr, x.data());
  for (int i = 0; i < x.size(); ++i) {
    const Parameter& parameter = scaling.parameters[i];
    if (std::isfinite(parameter.low) && !(parameter.positive && parameter.low <= 0.0))
      problem.SetParameterLowerBound(x.data(), i, scaling.to_x(i, parameter.low));
    if (std::isfinite(parameter.high))
      problem.SetParameterUpperBound(x.data(), i, scaling.to_x(i, parameter.high));
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations =
      level > 0 ? limits.coarse_iterations : options.iterations(*form.scene);
  // A fall of |r|^2 by less than a pixel's worth of noise is nothing: 1e-6 of some 1e6 pixels. A
  // misfit of some tenths of a pixel has some hundred effective residuals: 1e-3 of |r|^2 is a third
  // of a parameter's standard error.
  solver.function_tolerance = level > 0          ? limits.coarse_tolerance
                              : stage.registered ? limits.motion_tolerance
                                                 : limits.tolerance;
  solver.parameter_tolerance = 1e-7;
  // Levenberg's damping in units of what matters: the first step moves what the photos hardly fix
  // (the tilt of a flat body under one camera) by little, and each success by three times more.
  // Freed at once, such a direction would take up the others' misfit and turn the body over.
  solver.jacobi_scaling = false;
  solver.min_lm_diagonal = solver.initial_trust_region_radius;
  solver.logging_type = ceres::SILENT;
  // Where convexity bounds the values, steps shrink until they are nothing: that is an end.
  solver.max_num_consecutive_invalid_steps = cost.named_addends() ? 20 : 8;
  Reporter reporter(options, limits, cost, stage, seen.count, std::min(seen.misfit, 30.0),
                    solver.max_num_iterations);
  solver.callbacks.push_back(&reporter);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (options.cancel && options.cancel->load()) return stopped();
  if (summary.termination_type == ceres::FAILURE)
    return no_result(cost.failure().value_or(NumericalFailure{"", 0.0, summary.message}));
  return StageResult{scaling.to_p(x),
                     summary.termination_type == ceres::CONVERGENCE ||
                         summary.termination_type == ceres::USER_SUCCESS,
                     static_cast<int>(summary.iterations.size()), reporter.smallest_eigenvalue()};
}

}  // namespace hookeye
