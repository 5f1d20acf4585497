#include "estimation/fit.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "capture_io/input_error.h"
#include "estimation/additive_material.h"
#include "estimation/convex_fit.h"
#include "estimation/normal_equations.h"

namespace hookeye {

namespace {

/// Which examples move which parameters.
struct Scope {
  bool held_out = false;     ///< the held-out examples, not the fitted ones
  std::vector<bool> moving;  ///< by parameter
  int only = -1;             ///< this example alone, -1: all
  void choose(EvaluationOptions& options) const {
    options.fitted = !held_out;
    options.held_out = held_out;
    if (only >= 0) options.only = {only};
  }
  /// A parameter that stands still has no column: condense() leaves such where they are.
  NormalEquations of(const Evaluation& evaluation) const {
    NormalEquations sums = normal_equations(evaluation, held_out);
    sums.JtJ = part_of(sums.JtJ, moving);
    for (Eigen::Index i = 0; i < sums.Jtr.size(); ++i)
      if (!moving[i]) sums.Jtr[i] = 0.0;
    return sums;
  }
};

class ReducedCost final : public ceres::CostFunction {
 public:
  ReducedCost(Workspace& workspace, const ModelForm& form, const Scope& scope,
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
      if (named_addends_ && (failure_ = not_convex(form_.realise(p)))) return false;
      auto result = workspace_.evaluate(form_, p, options_);
      if (auto* failure = std::get_if<NumericalFailure>(&result)) {
        failure_ = *failure;
        return false;
      }
      cached_ = condense(scope_.of(std::get<Evaluation>(result)), scaling_.dp_dx(p));
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
  /// Fall of |r|^2 that the next Gauss-Newton step promises, and |r|^2 itself.
  double promised() const { return cached_.z.squaredNorm(); }
  double r2() const { return cached_.z.squaredNorm() + cached_.rho * cached_.rho; }

 private:
  Workspace& workspace_;
  const ModelForm& form_;
  const Scope& scope_;
  const Scaling& scaling_;
  EvaluationOptions options_;
  bool named_addends_ = false;  ///< values of an additive law: steps must stay convex
  mutable VectorXd cached_x_;
  mutable CondensedResidual cached_;
  mutable std::optional<NumericalFailure> failure_;
};

/// One look at the pictures after another: coarse; full size, made linear in the motion; full size.
struct Stage {
  int level = 0;
  bool registered = false;
  bool always = false;
  std::string name() const {
    if (level > 0) return fmt::format("1/{} size", 1 << level);
    return registered ? "motion" : "full size";
  }
  /// Beyond kLinearPx Gauss-Newton on pixels creeps, and on the motion between the pictures it does
  /// not.
  bool serves(double motion_px) const {
    return always || level > 0 || registered == (motion_px > kLinearPx);
  }
};

class Reporter final : public ceres::IterationCallback {
 public:
  Reporter(const FitOptions& options, const ReducedCost& cost, Stage stage, double count,
           double misfit, int of)
      : options_(options), cost_(cost), stage_(stage), count_(count), misfit_(misfit), of_(of) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (options_.cancel && options_.cancel->load()) return ceres::SOLVER_ABORT;
    if (done(summary)) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (options_.progress)
      options_.progress({stage_.name(), summary.iteration, of_, chi(summary.cost)});
    return ceres::SOLVER_CONTINUE;
  }

 private:
  /// A promised fall of 0.01 moves the parameters by a tenth of their standard deviation under
  /// white noise; below 1e-6 of |r|^2 rays that change triangles hide it (two evaluations 1e-6
  /// apart in a modulus differ by some 1e-5), and at 1e-5 moduli stopped a standard error short. A
  /// refused step that changed next to nothing has met the same limit. A structured misfit moves
  /// the parameters by more than noise does: the limit grows with its square. A coarse picture only
  /// has to lead the next one to the right speckle.
  bool done(const ceres::IterationSummary& summary) {
    if (stage_.level > 1 && cost_.promised() < 0.02 * cost_.r2()) return true;
    // Some hundred effective residuals: 1e-4 of |r|^2 is about a tenth of a standard error.
    if (stage_.registered && cost_.promised() < 1e-4 * cost_.r2()) return true;
    if (!summary.step_is_successful)
      return summary.iteration > 0 && std::abs(summary.cost_change) < 1e-4 * summary.cost;
    if (cost_.promised() < std::max(0.01, 1e-6 * misfit_ * misfit_ * cost_.r2())) return true;
    return stage_.level == 0 && !stage_.registered && summary.iteration > 0 && creeps(summary);
  }

  /// Two steps in a row that gained nothing that counts. Of a structured misfit, whose effective
  /// residuals are some hundred, 1e-3 of |r|^2 is a third of a standard error, whatever was
  /// promised: near a fold of the equilibria derivatives hold for tiny steps alone. Steps on the
  /// way to `aim_chi` count where twenty of them would arrive.
  bool creeps(const ceres::IterationSummary& summary) {
    const double chi = this->chi(summary.cost);
    const double structured = 1.0 - 1.0 / std::max(1.0, chi * chi);
    const double fell = this->chi(summary.cost + summary.cost_change) - chi;
    const bool counts = summary.cost_change > (1e-6 + 1e-3 * structured) * summary.cost;
    const bool arrives = options_.aim_chi == 0.0 || 20.0 * fell > chi - options_.aim_chi;
    slow_ = counts && arrives ? 0 : slow_ + 1;
    return slow_ == 2;
  }
  double chi(double cost) const { return std::sqrt(2.0 * cost / std::max(1.0, count_)); }

  const FitOptions& options_;
  const ReducedCost& cost_;
  Stage stage_;
  double count_, misfit_;
  int of_;
  int slow_ = 0;  ///< steps in a row
};

}  // namespace

EvaluationOptions only_pictures(int level, const FitOptions& options) {
  EvaluationOptions evaluation;
  evaluation.derivatives = false;
  evaluation.pictures = true;
  evaluation.level = level;
  evaluation.registered = level <= 1;
  evaluation.cancel = options.cancel;
  return evaluation;
}

double misfit_scale(const Evaluation& evaluation) {
  std::vector<float> sample;
  for (const auto& example : evaluation.examples)
    for (const auto& photo : example.photos)
      for (size_t i = 0; i < photo.residual.values.size(); i += 7)
        if (!std::isnan(photo.residual.values[i]))
          sample.push_back(std::abs(photo.residual.values[i]));
  if (sample.empty()) return 1.0;
  std::nth_element(sample.begin(), sample.begin() + sample.size() / 2, sample.end());
  return std::max(1.0, 1.4826 * static_cast<double>(sample[sample.size() / 2]));
}

namespace {

double photo_count(const Evaluation& evaluation) {
  double count = 0.0;
  for (const auto& example : evaluation.examples)
    for (const auto& photo : example.photos) count += photo.count;
  return count;
}

struct StageResult {
  VectorXd p;
  bool converged = false;
  int iterations = 0;
};

/// What a stage has to know of the pictures before it starts.
struct Look {
  double misfit = 1.0;  ///< misfit_scale
  double count = 0.0;   ///< pixels
  double motion_px = 0.0;
};

std::variant<Look, NumericalFailure> look(Workspace& workspace, const ModelForm& form,
                                          const VectorXd& p, const FitOptions& options,
                                          const Scope& scope, int level) {
  EvaluationOptions pictures_alone = only_pictures(level, options);
  scope.choose(pictures_alone);
  auto seen = workspace.evaluate(form, p, pictures_alone);
  if (auto* failure = std::get_if<NumericalFailure>(&seen)) return *failure;
  const Evaluation& pictures = std::get<Evaluation>(seen);
  return Look{misfit_scale(pictures), photo_count(pictures), pictures.motion_px()};
}

std::variant<StageResult, NumericalFailure> run_stage(Workspace& workspace, const ModelForm& form,
                                                      const VectorXd& start,
                                                      const FitOptions& options, const Scope& scope,
                                                      Stage stage, const Look& seen) {
  const int level = stage.level;
  EvaluationOptions evaluation;
  scope.choose(evaluation);
  evaluation.level = level;
  evaluation.registered = stage.registered;
  evaluation.most_iterations = kStepIterations;
  evaluation.cancel = options.cancel;
  evaluation.huber = options.huber > 0.0 ? options.huber * seen.misfit : 0.0;

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
  solver.max_num_iterations = level > 0 ? 8 : options.max_iterations;
  // A fall of |r|^2 by less than a pixel's worth of noise is nothing: 1e-6 of some 1e6 pixels. A
  // misfit of some tenths of a pixel has some hundred effective residuals: 1e-3 of |r|^2 is a third
  // of a parameter's standard error.
  solver.function_tolerance = level > 0 ? 1e-4 : stage.registered ? 1e-3 : 1e-6;
  solver.parameter_tolerance = 1e-7;
  // Levenberg's damping in units of what matters: the first step moves what the photos hardly fix
  // (the tilt of a flat body under one camera) by little, and each success by three times more.
  // Freed at once, such a direction would take up the others' misfit and turn the body over.
  solver.jacobi_scaling = false;
  solver.min_lm_diagonal = solver.initial_trust_region_radius;
  solver.logging_type = ceres::SILENT;
  // Where convexity bounds the values, steps shrink until they are nothing: that is an end.
  solver.max_num_consecutive_invalid_steps = cost.named_addends() ? 20 : 8;
  Reporter reporter(options, cost, stage, seen.count, std::min(seen.misfit, 30.0),
                    solver.max_num_iterations);
  solver.callbacks.push_back(&reporter);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (options.cancel && options.cancel->load()) return NumericalFailure{"", 0.0, "cancelled"};
  if (summary.termination_type == ceres::FAILURE)
    return cost.failure().value_or(NumericalFailure{"", 0.0, summary.message});
  return StageResult{scaling.to_p(x),
                     summary.termination_type == ceres::CONVERGENCE ||
                         summary.termination_type == ceres::USER_SUCCESS,
                     static_cast<int>(summary.iterations.size())};
}

}  // namespace

std::variant<Fitted, NumericalFailure> assess(Workspace& workspace, const ModelForm& form,
                                              const VectorXd& p, const FitOptions& options) {
  if (options.progress) options.progress({"final", 0, 0, 0.0});
  EvaluationOptions evaluation;
  evaluation.pictures = true;
  evaluation.held_out = true;
  evaluation.cancel = options.cancel;
  auto result = workspace.evaluate(form, p, evaluation);
  if (auto* failure = std::get_if<NumericalFailure>(&result)) return *failure;
  Fitted out;
  out.form = form;
  out.p = p;
  out.evaluation = std::get<Evaluation>(std::move(result));
  const auto parameters = form.parameters();
  const Eigen::MatrixXd covariance =
      parameter_covariance(out.evaluation, parameters, p, &out.undetermined);
  out.low = out.high = p;
  for (int i = 0; i < p.size(); ++i) {
    const double half = kNormal95 * std::sqrt(std::max(0.0, covariance(i, i)));
    // positive parameters: the interval is symmetric in the logarithm
    out.low[i] = parameters[i].positive ? p[i] * std::exp(-half / p[i]) : p[i] - half;
    out.high[i] = parameters[i].positive ? p[i] * std::exp(half / p[i]) : p[i] + half;
    // nothing in the data moves with it: anything may be
    if (half == 0.0) out.low[i] = parameters[i].low, out.high[i] = parameters[i].high;
  }
  return out;
}

namespace {

/// Gauss-Newton follows a pattern only while it overlaps with itself. At 1/32 a misfit of some
/// tens of pixels is one pixel and speckle has averaged out; 1/8 brings the rest below a speckle.
std::vector<Stage> stages(const Scene& scene, bool coarse_to_fine) {
  int smallest = 1 << 20;
  for (const auto& camera : scene.capture.cameras)
    smallest = std::min({smallest, camera.width, camera.height});
  std::vector<Stage> all;
  for (int level : {5, 3})
    if (coarse_to_fine && (smallest >> level) >= 12) all.push_back({level, false});
  all.push_back({0, true});
  // Contours lead silhouettes home; the areas, which bound what a stray contour may do, decide.
  bool images = false;
  for (const auto& example : scene.capture.examples)
    for (const auto& photo : example.photos) images |= photo.kind == PhotoSpec::Kind::image;
  all.push_back({0, false, !images});
  return all;
}

/// Nothing seen and nothing measured would be fitted perfectly by any value.
void check_data(const Scene& scene, const Look& seen) {
  if (seen.count > 0.0) return;
  for (const auto& example : scene.capture.examples)
    if (!example.validate && !example.measured.empty()) return;
  throw InputError({scene.capture.file.string()},
                   "there is nothing to fit to: no pixel of a fitted example counts, and nothing "
                   "is measured there",
                   "look at masks, at where the cameras look and at `use:` (`hookeye check` tells "
                   "what every photo shows)");
}

/// Fits the numbers that concern one example alone, one example after the other: a jaw's tilt,
/// which one camera sees by its square alone, would hold up all others' steps with its own. Where
/// that fails they stay where they are.
VectorXd settle_examples(Workspace& workspace, const ModelForm& form, VectorXd p,
                         const FitOptions& options, const Scope& all, Stage stage) {
  const auto parameters = form.parameters();
  const auto& examples = form.scene->capture.examples;
  for (size_t e = 0; e < examples.size(); ++e) {
    Scope scope{all.held_out, std::vector<bool>(parameters.size(), false), static_cast<int>(e)};
    bool any = false;
    for (size_t i = 0; i < parameters.size(); ++i)
      any |= scope.moving[i] = all.moving[i] && parameters[i].example == scope.only;
    if (!any || examples[e].validate != all.held_out) continue;
    FitOptions own = options;
    if (options.progress)
      own.progress = [&](FitProgress progress) {
        progress.stage = "'" + examples[e].name + "' alone";
        options.progress(progress);
      };
    const auto seen = look(workspace, form, p, options, scope, stage.level);
    if (!std::holds_alternative<Look>(seen)) continue;
    auto ran = run_stage(workspace, form, p, own, scope, stage, std::get<Look>(seen));
    if (auto* settled = std::get_if<StageResult>(&ran)) p = std::move(settled->p);
  }
  return p;
}

/// From coarse to full size within a scope.
std::variant<StageResult, NumericalFailure> run_stages(Workspace& workspace, const ModelForm& form,
                                                       const VectorXd& start,
                                                       const FitOptions& options,
                                                       const Scope& scope) {
  StageResult out{start, true, 0};
  std::optional<Look> full_size;  // of p
  for (const Stage& stage : stages(workspace.scene(), options.coarse_to_fine)) {
    if (stage.level > 0 || !full_size) {
      auto first = look(workspace, form, out.p, options, scope, stage.level);
      if (auto* failure = std::get_if<NumericalFailure>(&first)) return *failure;
      full_size = std::get<Look>(first);
      if (!scope.held_out) check_data(workspace.scene(), *full_size);
    }
    const Look seen = *full_size;
    if (!stage.serves(seen.motion_px)) continue;
    full_size.reset();
    if (stage.level == 0 && !stage.registered)
      out.p = settle_examples(workspace, form, out.p, options, scope, stage);
    auto ran = run_stage(workspace, form, out.p, options, scope, stage, seen);
    if (auto* failure = std::get_if<NumericalFailure>(&ran)) return *failure;
    const auto& result = std::get<StageResult>(ran);
    out.p = result.p;
    out.iterations += result.iterations;
    if (stage.level == 0) out.converged = result.converged;
  }
  return out;
}

}  // namespace

std::variant<VectorXd, NumericalFailure> settle_held_out(Workspace& workspace,
                                                         const ModelForm& form, const VectorXd& p,
                                                         const FitOptions& options) {
  const Scope scope{true, of_held_out(form.scene->capture, form.parameters())};
  if (std::none_of(scope.moving.begin(), scope.moving.end(), [](bool own) { return own; }))
    return p;
  auto settled = run_stages(workspace, form, p, options, scope);
  if (auto* failure = std::get_if<NumericalFailure>(&settled)) return *failure;
  return std::get<StageResult>(settled).p;
}

std::variant<Fitted, NumericalFailure> fit(Workspace& workspace, const ModelForm& form,
                                           const VectorXd& start, const FitOptions& options) {
  if (start.size() != form.size()) throw std::logic_error("fit: wrong size of start");
  if (has_additive(form)) return fit_convex_to_end(workspace, form, start, options);
  StageResult result{start, true, 0};
  if (form.size() > 0) {
    const Scope scope{false, std::vector<bool>(form.size(), true)};
    auto ran = run_stages(workspace, form, start, options, scope);
    if (auto* failure = std::get_if<NumericalFailure>(&ran)) return *failure;
    result = std::get<StageResult>(std::move(ran));
  }
  auto settled = settle_held_out(workspace, form, result.p, options);
  if (auto* failure = std::get_if<NumericalFailure>(&settled)) return *failure;
  auto fitted = assess(workspace, form, std::get<VectorXd>(settled), options);
  if (auto* out = std::get_if<Fitted>(&fitted)) {
    out->iterations = result.iterations;
    out->converged = result.converged;
  }
  return fitted;
}

}  // namespace hookeye
