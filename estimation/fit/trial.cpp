#include "estimation/fit/trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/work_clock.h"
#include "estimation/fit/archived.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/fit.h"
#include "estimation/fit/floor.h"

namespace hookeye {

namespace {

constexpr int kHalfSize = 1;

/// Of the largest nodal force: moves nothing that half-size pictures show.
constexpr double kTrialTolerance = 1e-6;

EvaluationOptions half_size(const FitOptions& options) {
  EvaluationOptions out = only_pictures(kHalfSize, options);
  out.tolerance = kTrialTolerance;
  out.most_iterations = kStepIterations;
  return out;
}

/// Parameters after `share` of the Gauss-Newton step.
VectorXd after_step(const Scaling& scaling, const VectorXd& p, const NormalEquations& sums,
                    double share) {
  const CondensedResidual condensed = condense(within_bounds(sums, scaling, p), scaling.dp_dx(p));
  const VectorXd dx = -condensed.R.completeOrthogonalDecomposition().solve(condensed.z) * share;
  return bounded_step(scaling, p, dx);
}

}  // namespace

VectorXd bounded_step(const Scaling& scaling, const VectorXd& p, const VectorXd& dx) {
  VectorXd x = scaling.to_x(p);
  for (int i = 0; i < x.size(); ++i) {
    const double most = scaling.parameters[i].positive ? 1.0 : 10.0;
    x[i] += std::clamp(dx[i], -most, most);
  }
  return scaling.to_p(x);
}

namespace {

Result<TrialScale> scale_anew(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                              const FitOptions& options) {
  EvaluationOptions all = half_size(options);
  all.held_out = true;
  auto seen = workspace.evaluate(form, p, all);
  if (!seen && !(options.cancel && options.cancel->load()))
    seen = workspace.evaluate(form, p, half_size(options));  // a held-out example has none
  if (!seen) return failure_of(seen);
  Evaluation& pictures = *seen;
  const double held_out = pictures.linear_chi(true);
  std::erase_if(pictures.examples, [](const auto& example) { return example.held_out; });
  const Floor floor = measure_floor(workspace.scene(), pictures);
  return TrialScale{options.huber_times(*form.scene) * misfit_scale(pictures),
                    pictures.linear_chi(false), held_out,
                    floor.source.starts_with("rest") ? floor.chi : 0.0, measured_weight(floor)};
}

/// The trial with the numbers that concern held-out examples alone fitted to those: they suit the
/// model before the step.
Result<Trial> with_held_out(Workspace& workspace, const ModelForm& form, Trial trial,
                            const FitOptions& options) {
  const auto settled = settle_held_out(workspace, form, trial.p, options);
  if (!settled) return failure_of(settled);
  if (*settled == trial.p) return trial;
  EvaluationOptions pictures = half_size(options);
  pictures.held_out = true;
  const auto seen = workspace.evaluate(form, *settled, pictures);
  if (!seen) return failure_of(seen);
  trial.p = *settled;
  trial.chi_validate = seen->linear_chi(true);
  return trial;
}

Result<Trial> step_anew(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                        const TrialScale& scale, const FitOptions& options) {
  EvaluationOptions derivatives = half_size(options);
  derivatives.derivatives = true;
  derivatives.huber = scale.huber;
  derivatives.measured_weight = scale.measured_weight;
  const auto first = workspace.evaluate(form, start, derivatives);
  if (!first) return failure_of(first);
  const double from = first->linear_chi(false);
  // "from the null itself" comes back a little off: rays have changed triangles
  if (from > form.scene->limits->fit.trial_worse * scale.chi)
    return no_result({"", 0.0, "worse than the model without"});
  const NormalEquations sums = normal_equations(*first);
  EvaluationOptions pictures = half_size(options);
  pictures.held_out = true;
  Result<Evaluation> seen;
  for (double share : {1.0, 0.3, 0.1, 0.0}) {
    const VectorXd p = after_step({form.parameters()}, start, sums, share);
    seen = workspace.evaluate(form, p, pictures);
    if (seen)
      if (share == 0.0 || seen->linear_chi(false) < from)
        return with_held_out(workspace, form,
                             {p, seen->linear_chi(false), seen->linear_chi(true), scale.floor},
                             options);
    if (options.cancel && options.cancel->load()) return stopped();
  }
  return failure_of(seen);  // not even the start: a held-out example
}

}  // namespace

Result<TrialScale> trial_scale(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                               const FitOptions& options) {
  const WorkingAt stage(WorkStage::trials);
  const auto question = [&] {
    Question out = question_of("scale", form, p);
    out.numbers.push_back(options.huber_times(*form.scene));
    return out;
  };
  return archived<TrialScale>(
      {workspace, form, p, options.cancel, question},
      [&] { return scale_anew(workspace, form, p, options); },
      [](const TrialScale& scale) {
        return nlohmann::json{{"huber", scale.huber},
                              {"chi", scale.chi},
                              {"chi_validate", scale.chi_validate},
                              {"floor", scale.floor},
                              {"measured_weight", scale.measured_weight}};
      },
      [](const nlohmann::json& known) {
        return std::optional(TrialScale{known.at("huber"), known.at("chi"),
                                        known.at("chi_validate"), known.at("floor"),
                                        known.at("measured_weight")});
      });
}

Result<Trial> try_step(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                       const TrialScale& scale, const FitOptions& options) {
  const WorkingAt stage(WorkStage::trials);
  const auto question = [&] {
    Question out = question_of("trial", form, start);
    for (const double one : {scale.huber, scale.chi, scale.floor, scale.measured_weight})
      out.numbers.push_back(one);
    return out;
  };
  return archived<Trial>(
      {workspace, form, start, options.cancel, question},
      [&] { return step_anew(workspace, form, start, scale, options); },
      [](const Trial& trial) {
        return nlohmann::json{{"p", vector_json(trial.p)},
                              {"chi_fit", trial.chi_fit},
                              {"chi_validate", trial.chi_validate},
                              {"floor", trial.floor}};
      },
      [](const nlohmann::json& known) {
        return std::optional(Trial{vector_from(known.at("p")), known.at("chi_fit"),
                                   known.at("chi_validate"), known.at("floor")});
      });
}

double over_floor(const Trial& trial) {
  const auto over = [&](double chi) {
    return std::max(0.0, chi * chi - trial.floor * trial.floor);
  };
  return over(trial.chi_fit) + over(trial.chi_validate);
}

Result<Followed> follow(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                        const TrialScale& scale, const FitOptions& options, int steps) {
  TrialScale any = scale;  // the start may be worse than the model that it is held against
  any.chi = std::numeric_limits<double>::infinity();
  Followed out;
  out.trial.p = start;
  for (int step = 0; step < steps && !out.stalled; ++step) {
    auto result = try_step(workspace, form, out.trial.p, any, options);
    if (!result) {
      if (step == 0 || cancelled(result.error())) return failure_of(result);
      break;
    }
    const double before = over_floor(out.trial);
    out.trial = *std::move(result);
    out.stalled =
        step > 0 && over_floor(out.trial) > (1.0 - form.scene->limits->fit.trial_stalled) * before;
  }
  return out;
}

}  // namespace hookeye
