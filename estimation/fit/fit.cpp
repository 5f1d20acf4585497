#include "estimation/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/distributions.h"
#include "core/input_error.h"
#include "core/work_clock.h"
#include "estimation/fit/archived.h"
#include "estimation/fit/convex_fit.h"
#include "estimation/fit/fit_stage.h"
#include "estimation/fit/floor.h"
#include "estimation/model/additive_material.h"

namespace hookeye {

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

VectorXd errors_of(const ParameterCovariance& covariance) {
  VectorXd out = covariance.determined.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Eigen::Index i = 0; i < out.size(); ++i)
    if (covariance.open[static_cast<size_t>(i)]) out[i] = 0.0;
  return out;
}

void tell_intervals(const VectorXd& error, const VectorXd& about, Fitted* fitted) {
  const auto parameters = fitted->form.parameters();
  const VectorXd& p = fitted->p;
  fitted->low = fitted->high = p;
  for (int i = 0; i < p.size(); ++i) {
    const double half = kNormal95 * error[i];
    // positive parameters: the interval is symmetric in the logarithm
    fitted->low[i] = parameters[i].positive ? about[i] * std::exp(-half / p[i]) : about[i] - half;
    fitted->high[i] = parameters[i].positive ? about[i] * std::exp(half / p[i]) : about[i] + half;
    // nothing in the data holds it: anything may be
    if (half == 0.0) fitted->low[i] = parameters[i].low, fitted->high[i] = parameters[i].high;
  }
}

void widen_by_mesh(Fitted& fitted) {
  const auto parameters = fitted.form.parameters();
  for (int i = 0; i < fitted.mesh_reach.size(); ++i) {
    const double reach = fitted.mesh_reach[i];
    double& end = (reach < 0.0 ? fitted.low : fitted.high)[i];
    end = parameters[i].positive ? end * std::exp(reach / fitted.p[i]) : end + reach;
  }
}

namespace {

bool is_cancelled(const FitOptions& options) { return options.cancel && options.cancel->load(); }

Result<Fitted> assess_anew(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                           const FitOptions& options) {
  if (options.progress) options.progress({"final", 0, 0, 0.0});
  EvaluationOptions evaluation;
  evaluation.pictures = true;
  evaluation.held_out = true;
  evaluation.most_iterations = options.most_iterations;
  evaluation.cancel = options.cancel;
  auto result = workspace.evaluate(form, p, evaluation);
  if (!result) return failure_of(result);
  Fitted out;
  out.form = form;
  out.p = p;
  out.evaluation = *std::move(result);
  out.evaluation.measured_weight = measured_weight(workspace.scene(), out.evaluation);
  const auto parameters = form.parameters();
  const ParameterCovariance covariance = parameter_covariance(out.evaluation, parameters, p);
  out.undetermined = covariance.directions;
  tell_intervals(errors_of(covariance), p, &out);
  return out;
}

}  // namespace

Result<Fitted> assess(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                      const FitOptions& options) {
  const auto question = [&] {
    Question out = question_of("state", form, p);
    out.numbers.push_back(options.most_iterations);
    return out;
  };
  return archived<Fitted>(
      {workspace, form, p, options.cancel, question, true},
      [&] { return assess_anew(workspace, form, p, options); },
      [&](const Fitted& fitted) {
        return nlohmann::json{{"states", states_json(fitted.evaluation)}};
      },
      [&](const nlohmann::json& known) -> std::optional<Result<Fitted>> {
        workspace.start_from(place_from(known.at("states"), workspace.place()));
        auto again = assess_anew(workspace, form, p, options);
        if (again || is_cancelled(options)) return again;
        return {};
      });
}

namespace {

/// Gauss-Newton follows a pattern only while it overlaps with itself. At 1/32 a misfit of some
/// tens of pixels is one pixel and speckle has averaged out; 1/8 brings the rest below a speckle.
std::vector<Stage> stages(const Scene& scene, bool coarse_to_fine) {
  int smallest = 1 << 20;
  for (const auto& camera : scene.capture.cameras)
    smallest = std::min({smallest, camera.width, camera.height});
  std::vector<Stage> all;
  const bool seen = std::any_of(scene.capture.examples.begin(), scene.capture.examples.end(),
                                [](const auto& example) { return !example.photos.empty(); });
  for (int level : {5, 3})
    if (coarse_to_fine && seen && (smallest >> level) >= 12) all.push_back({level, false});
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
                         const FitOptions& options, const FitScope& all, Stage stage) {
  const auto parameters = form.parameters();
  const auto& examples = form.scene->capture.examples;
  for (size_t e = 0; e < examples.size(); ++e) {
    FitScope scope{all.held_out, std::vector<bool>(parameters.size(), false), static_cast<int>(e)};
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
    if (!seen.has_value()) continue;
    auto ran = run_stage(workspace, form, p, own, scope, stage, *seen);
    if (ran) p = std::move(ran->p);
  }
  return p;
}

double numbers_moved(const FitScope& scope) {
  return static_cast<double>(std::count(scope.moving.begin(), scope.moving.end(), true));
}

/// From coarse to full size within a scope.
Result<StageResult> run_stages(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                               const FitOptions& options, const FitScope& scope) {
  StageResult out{start, true};
  std::optional<Look> full_size;  // of p
  for (const Stage& stage : stages(workspace.scene(), options.coarse_to_fine)) {
    if (stage.level > 0 || !full_size) {
      auto first = look(workspace, form, out.p, options, scope, stage.level);
      if (!first) return failure_of(first);
      // A body that is thin in the photos has no pixel of its own where they are small.
      if (stage.level > 0 && first->count <= numbers_moved(scope)) continue;
      full_size = *first;
      if (!scope.held_out) check_data(workspace.scene(), *full_size);
    }
    const Look seen = *full_size;
    if (!stage.serves(seen.motion_px)) continue;
    full_size.reset();
    if (stage.level == 0 && !stage.registered)
      out.p = settle_examples(workspace, form, out.p, options, scope, stage);
    auto ran = run_stage(workspace, form, out.p, options, scope, stage, seen);
    if (!ran) return failure_of(ran);
    const auto& result = *ran;
    out.p = result.p;
    out.iterations += result.iterations;
    out.smallest_eigenvalue = std::fmin(out.smallest_eigenvalue, result.smallest_eigenvalue);
    if (stage.level == 0) out.converged = result.converged;
  }
  return out;
}

}  // namespace

Result<VectorXd> settle_held_out(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                                 const FitOptions& options) {
  const FitScope scope{true, of_held_out(form.scene->capture, form.parameters())};
  if (std::none_of(scope.moving.begin(), scope.moving.end(), [](bool own) { return own; }))
    return p;
  auto settled = run_stages(workspace, form, p, options, scope);
  if (!settled) return failure_of(settled);
  return settled->p;
}

namespace {

/// What coarse pictures of p and measured values leave, a sum of squares over noise; infinite where
/// p has no equilibrium.
double coarse_misfit(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                     const FitOptions& options) {
  const int level = stages(workspace.scene(), true).front().level;
  const auto result = workspace.evaluate(form, p, only_pictures(level, options));
  if (!result) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const auto& example : result->examples) {
    for (const auto& photo : example.photos) sum += photo.r2;
    for (const auto& measured : example.measured) sum += measured.r.squaredNorm();
  }
  return sum;
}

/// All moduli times two, or over two, for as long as coarse pictures come nearer: a body that hangs
/// far from where the photos show it has no slope towards them. Empty: they do not.
std::optional<VectorXd> rescaled(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                                 const FitOptions& options) {
  const auto parameters = form.parameters();
  const auto at = [&](double factor) {
    VectorXd q = p;
    for (int i = 0; i < q.size(); ++i)
      if (is_modulus(parameters[i]))
        q[i] = std::clamp(factor * q[i], parameters[i].low, parameters[i].high);
    return q;
  };
  double least = coarse_misfit(workspace, form, p, options);
  const bool stands = std::isfinite(least);
  for (const double step : {2.0, 0.5}) {
    if (!stands && step < 1.0) break;  // what has no equilibrium finds none softer
    double best = 1.0, factor = 1.0;
    for (int i = 0; i < form.scene->limits->fit.rescalings; ++i) {
      const double misfit = coarse_misfit(workspace, form, at(factor *= step), options);
      if (misfit < least)
        least = misfit, best = factor;
      else if (std::isfinite(least))
        break;
    }
    if (best != 1.0) return at(best);
  }
  return {};
}

/// Pictures are farther apart than what they show leads home.
bool lost(const Fitted& fitted) {
  const auto parameters = fitted.form.parameters();
  return fitted.evaluation.rms_px(false) > fitted.form.scene->limits->fit.lost_px &&
         std::any_of(parameters.begin(), parameters.end(), is_modulus);
}

/// From `start` to the end: the fitted examples, the held-out ones' own numbers, intervals.
Result<Fitted> fit_from(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                        const FitOptions& options) {
  StageResult result{start, true};
  if (form.size() > 0) {
    const FitScope scope{false, std::vector<bool>(form.size(), true)};
    auto ran = run_stages(workspace, form, start, options, scope);
    if (!ran) return failure_of(ran);
    result = *std::move(ran);
  }
  auto settled = settle_held_out(workspace, form, result.p, options);
  if (!settled) return failure_of(settled);
  auto fitted = assess(workspace, form, *settled, options);
  if (fitted) {
    fitted->iterations = result.iterations;
    fitted->converged = result.converged;
    fitted->smallest_eigenvalue = result.smallest_eigenvalue;
  }
  return fitted;
}

}  // namespace

Model realised(const Fitted& fitted) {
  Model model = fitted.form.realise(fitted.p);
  model.states.resize(model.examples.size());
  for (const auto& example : fitted.evaluation.examples)
    model.states[example.example] = example.equilibrium;
  return model;
}

namespace {

Result<Fitted> fit_anew(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                        const FitOptions& options) {
  if (has_additive(form)) return fit_convex_to_end(workspace, form, start, options);
  auto fitted = fit_from(workspace, form, start, options);
  if (!options.coarse_to_fine || is_cancelled(options) || (fitted && !lost(*fitted))) return fitted;
  const auto nearer = rescaled(workspace, form, fitted ? fitted->p : start, options);
  if (!nearer) return fitted;
  auto again = fit_from(workspace, form, *nearer, options);
  if (is_cancelled(options)) return again;
  const bool better =
      again && (!fitted || again->evaluation.chi(false) < fitted->evaluation.chi(false));
  return better ? again : fitted;
}

Question question_of_fit(const ModelForm& form, const VectorXd& start, const FitOptions& options) {
  Question question = question_of("fit", form, start);
  for (const double one :
       {1.0 * options.iterations(*form.scene), 1.0 * options.coarse_to_fine,
        options.huber_times(*form.scene), options.aim_chi, 1.0 * options.most_iterations})
    question.numbers.push_back(one);
  return question;
}

nlohmann::json fit_json(const Fitted& fitted) {
  return {{"p", vector_json(fitted.p)},
          {"chi", {fitted.evaluation.chi(false), fitted.evaluation.chi(true)}},
          {"iterations", fitted.iterations},
          {"converged", fitted.converged},
          {"smallest_eigenvalue", fitted.smallest_eigenvalue}};
}

/// The fit that ended so. Empty: it does not look as it did, from another equilibrium.
std::optional<Result<Fitted>> fit_from_json(Workspace& workspace, const ModelForm& form,
                                            const nlohmann::json& known,
                                            const FitOptions& options) {
  auto fitted = assess(workspace, form, vector_from(known.at("p")), options);
  if (is_cancelled(options)) return fitted;
  if (!fitted) return {};
  for (const bool held_out : {false, true}) {
    const double chi = known.at("chi").at(held_out ? 1 : 0);
    if (std::abs(fitted->evaluation.chi(held_out) - chi) > 1e-3 * chi) return {};
  }
  fitted->iterations = known.at("iterations");
  fitted->converged = known.at("converged");
  fitted->smallest_eigenvalue = known.at("smallest_eigenvalue");
  return fitted;
}

}  // namespace

Result<Fitted> fit(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                   const FitOptions& options) {
  if (start.size() != form.size()) throw std::logic_error("fit: wrong size of start");
  const WorkingAt stage(WorkStage::fit);
  return archived<Fitted>(
      {workspace, form, start, options.cancel,
       [&] { return question_of_fit(form, start, options); }},
      [&] { return fit_anew(workspace, form, start, options); }, fit_json,
      [&](const nlohmann::json& known) { return fit_from_json(workspace, form, known, options); });
}

}  // namespace hookeye
