#include "estimation/diagnosis/diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "capture_io/seen_in_words.h"
#include "core/input_error.h"
#include "core/work_clock.h"
#include "estimation/diagnosis/candidates.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/diagnosis/mesh_error.h"
#include "estimation/diagnosis/seen.h"
#include "estimation/evaluation/gram.h"
#include "estimation/fit/archived.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/evidence.h"

namespace hookeye {

namespace {

VectorXd joint_step(int columns, const ProjectedHypothesis& hypothesis, const EffectScore& score,
                    const VectorXd& null_values) {
  VectorXd step = VectorXd::Zero(columns);
  step.head(hypothesis.base) = score.base_step;
  step.segment(hypothesis.first, score.dof) = score.values - null_values;
  return step;
}

VectorXd nulls(const Ingredient& ingredient) {
  const auto parameters = ingredient.parameters();
  VectorXd values(parameters.size());
  for (size_t i = 0; i < parameters.size(); ++i) values[i] = parameters[i].value;
  return values;
}

void displace(const Evaluation& evaluation, const ProjectedHypothesis& hypothesis,
              EffectScore& score) {
  const VectorXd step = joint_step(evaluation.columns, hypothesis, score, nulls(*score.best));
  for (const auto& example : evaluation.examples)
    score.displaced[example.example] = example.equilibrium->q + example.S * step;
}

struct Context {
  const Fitted& fitted;
  const Scene& scene;
  const Evaluation& evaluation;
  const DiagnosisSums& sums;
  const Model model;
  const Diagnosis& diagnosis;  ///< what of it is known before the effects
};

EffectScore describe(const Context& context, const Candidate& candidate,
                     const ProjectedHypothesis& weighted, double evidence) {
  EffectScore score;
  score.effect = candidate.effect->name();
  score.evidence = evidence;
  score.best = candidate.ingredient;
  score.dof = candidate.hypothesis.count;
  const auto parameters = candidate.ingredient->parameters();
  const VectorXd null_values = nulls(*candidate.ingredient);
  // The step and its share come from the plain sums: that is what a refit will minimise.
  const ProjectedHypothesis plain =
      project(context.sums.fitted.JtJ, weighted.base, candidate.hypothesis);
  VectorXd low(score.dof), high(score.dof);
  for (int i = 0; i < score.dof; ++i) low[i] = parameters[i].low, high[i] = parameters[i].high;
  score.values = null_values +
                 plain.step_within(context.sums.fitted.Jtr, low - null_values, high - null_values);
  score.values = score.values.cwiseMax(low).cwiseMin(high);  // null + (bound - null) rounds
  score.base_step = -plain.to_base * (score.values - null_values);
  const DiagnosisSums& sums = context.sums;
  const double structured = sums.photo_r2 - sums.photo_count * sums.pixel_floor2;
  const double held = sums.held_r2 - sums.held_count * sums.pixel_floor2;
  const VectorXd step = joint_step(context.evaluation.columns, weighted, score, null_values);
  const double fall = -change(sums.seen.JtJ, sums.seen.Jtr, step);
  if (structured > 0.0) score.explains = std::clamp(fall / structured, 0.0, 1.0) + 0.0;  // no -0
  score.fall = fall / std::max(sums.photo_count, 1.0);
  if (held > 0.0) {
    const double taken = -change(sums.seen_held_out.JtJ, sums.seen_held_out.Jtr, step);
    score.explains_held_out = std::clamp(taken / held, -1.0, 1.0);
    score.fall_held_out = taken / sums.held_count;
  }
  const Eigen::MatrixXd V = context.sums.noise.block(
      candidate.hypothesis.first, candidate.hypothesis.first, score.dof, score.dof);
  const Eigen::MatrixXd inverse = weighted.inverse();
  score.standard_error = (inverse * V * inverse).diagonal().cwiseMax(0.0).cwiseSqrt();
  const std::string sentence =
      candidate.effect->sentence(context.model, *candidate.ingredient, score.values);
  const double before = measured_r2(context.evaluation);
  const double after = measured_r2(context.evaluation, &step);
  score.measured_fall = before - after;
  const bool hidden =
      score.fall < least_fall(context.diagnosis, score.effect) || context.diagnosis.held_out_missed;
  score.why = sensors_alone(*candidate.ingredient)
                  ? sentence + "; seen in what was measured alone"
                  : fmt::format("{} would remove {:.0f} % of the misfit{}{}", sentence,
                                100.0 * score.explains,
                                hidden && held_out_say_so(score, context.diagnosis)
                                    ? fmt::format(" and {:.0f} % of the held-out {}'",
                                                  100.0 * score.explains_held_out,
                                                  seen_in_words(context.scene.capture))
                                    : "",
                                where_seen(context.scene, context.evaluation, step));
  if (!sensors_alone(*candidate.ingredient) &&
      score.measured_fall >= 2.0 * context.diagnosis.limits().nameable)
    score.why += seen_by_sensors(before, after, sums.measured_count);
  return score;
}

double information_of(const DiagnosisSums& sums, const ProjectedHypothesis& hypothesis, double r2) {
  const auto& all = sums.effective;  // photos and all that is measured
  return bayes_information(hypothesis, all.s, r2, all.count, all.floor2);
}

/// Of all forms of an effect the one that explains most of the held-out photos, where that is more
/// than the best of the fitted ones does there by a twentieth of their misfit, or where the fitted
/// ones cannot tell the two apart: what is linear in a form's parameters says little of a large
/// one. A form that explains not half of what the best does would get nowhere in a race
/// (gets_farther); that it spoils no held-out photo is no merit.
std::shared_ptr<const EffectScore> other_form(const Context& context,
                                              const std::vector<Candidate>& candidates,
                                              const std::vector<ProjectedHypothesis>& projected,
                                              double r2, const EffectScore& best) {
  const DiagnosisLimits& limits = context.diagnosis.limits();
  std::shared_ptr<const EffectScore> out;
  for (size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].effect->name() != best.effect || candidates[i].ingredient == best.best)
      continue;
    EffectScore score = describe(context, candidates[i], projected[i], best.evidence);
    const bool tie = information_of(context.sums, projected[i], r2) > best.bic - limits.tie;
    if ((tie || score.explains_held_out > best.explains_held_out + limits.form_held_out_more) &&
        score.explains > limits.form_explains * best.explains &&
        (!out || score.explains_held_out > out->explains_held_out))
      out = std::make_shared<EffectScore>(std::move(score));
  }
  return out;
}

/// Scores again, without them, the hypotheses that would step below their bounds.
void keep_within_bounds(const DiagnosisSums& sums, int base, double r2,
                        std::vector<Candidate>& candidates,
                        std::vector<ProjectedHypothesis>& projected, VectorXd& evidence) {
  for (size_t i = 0; i < candidates.size(); ++i) {
    Hypothesis& hypothesis = candidates[i].hypothesis;
    hypothesis = within_bounds(sums.effective.H, base, hypothesis, sums.effective.s);
    if (hypothesis.held.empty()) continue;
    projected[i] = project(sums.effective.H, base, hypothesis);
    evidence[i] = log_evidence(projected[i], sums.effective.s, r2, sums.effective.count,
                               sums.effective.floor2);
  }
}

void weigh(std::vector<EffectScore>& scores) {
  double largest = 0.0, sum = 0.0;
  for (const auto& score : scores)
    if (score.testable) largest = std::max(largest, score.evidence);
  for (const auto& score : scores)
    if (score.testable) sum += std::exp(score.evidence - largest);
  for (auto& score : scores)
    if (score.testable) score.weight = std::exp(score.evidence - largest) / sum;
}

}  // namespace

namespace {

/// The candidates with their evidence, and the best one of every effect.
struct Scored {
  std::vector<Candidate> candidates;
  std::vector<ProjectedHypothesis> projected;
  VectorXd evidence;
  double r2 = 0.0;  ///< effective residual without what the base columns can make
  std::map<std::string, size_t> best;
  std::vector<double> null;  ///< simulate_null()

  double p_value(double value) const {
    const auto above = null.end() - std::lower_bound(null.begin(), null.end(), value);
    return (1.0 + above) / (1.0 + null.size());
  }
};

Scored score_photos(const ModelForm& form, std::vector<Candidate> candidates,
                    const DiagnosisSums& sums, const DiagnosisOptions& options) {
  const int base = form.size();
  Scored out;
  out.r2 = without_base(sums.effective, base, form.scene->limits->diagnosis);
  out.evidence.resize(candidates.size());
  for (size_t i = 0; i < candidates.size(); ++i) {
    out.projected.push_back(project(sums.effective.H, base, candidates[i].hypothesis));
    out.evidence[i] = log_evidence(out.projected[i], sums.effective.s, out.r2, sums.effective.count,
                                   sums.effective.floor2);
  }
  out.null = simulate_null(form, candidates, out.projected, sums, options);
  keep_within_bounds(sums, base, out.r2, candidates, out.projected, out.evidence);
  out.candidates = std::move(candidates);
  return out;
}

/// The null is at the floor, where one noise holds for all; a misfit of the photos is none of the
/// sensors', and what a finer mesh would change in their values (`mesh2`, over noise) no error of
/// theirs.
void score_sensors(const DiagnosisSums& sums, int base, double mesh2, const DiagnosisLimits& limits,
                   Scored& scored) {
  if (sums.measured.count <= 0.0) return;
  for (size_t i = 0; i < scored.candidates.size(); ++i)
    if (sensors_alone(*scored.candidates[i].ingredient))
      scored.evidence[i] = log_evidence_of_told_noise(
          project(sums.measured.H, base, scored.candidates[i].hypothesis), sums.measured.s,
          without_base(sums.measured, base, limits), sums.measured_count, 1.0 + mesh2);
}

EffectScore score_effect(const Context& context, const Scored& scored, size_t best, double evidence,
                         const Diagnosis& diagnosis) {
  const Candidate& candidate = scored.candidates[best];
  const ProjectedHypothesis& projected = scored.projected[best];
  EffectScore score = describe(context, candidate, projected, evidence);
  score.mesh_fall = brightness_alone(*score.best)
                        ? imitated_by_mesh(context.fitted, context.sums, candidate.hypothesis)
                        : diagnosis.mesh_fall;
  score.bic =
      sensors_alone(*score.best) ? evidence : information_of(context.sums, projected, scored.r2);
  if (evidence >= diagnosis.limits().nameable)
    score.other_form = other_form(context, scored.candidates, scored.projected, scored.r2, score);
  score.p_value = scored.p_value(evidence);
  // What the photos show they can test, however little a typical change would show of it.
  if (projected.best_signal() < std::pow(diagnosis.limits().testable_deviations, 2) &&
      evidence < std::max(diagnosis.limits().nameable, diagnosis.gate)) {
    score.testable = false;
    score.why_not = fmt::format(
        "untestable with these {}: a change that would matter moves them by "
        "less than two standard deviations",
        seen_in_words(context.scene.capture));
  }
  return score;
}

/// Drawn, or speaks: it is told where it takes the body.
bool is_displaced(const EffectScore& score, const DiagnosisLimits& limits) {
  return score.pictured ||
         (score.testable && score.evidence >= limits.nameable && !sensors_alone(*score.best));
}

/// Which of the ranked effects are drawn, and where those and all that speak take the body.
void displace_leaders(const Evaluation& evaluation, const Scored& scored,
                      const DiagnosisLimits& limits, std::vector<EffectScore>& effects) {
  for (size_t i = 0; i < effects.size(); ++i) {
    EffectScore& score = effects[i];
    score.pictured = score.testable && static_cast<int>(i) < limits.pictured;
    if (is_displaced(score, limits))
      displace(evaluation, scored.projected[scored.best.at(score.effect)], score);
  }
}

/// The model's pictures and their derivatives by its own parameters and all candidates'.
Result<Evaluation> evaluate_for(Workspace& workspace, const Fitted& fitted,
                                const std::vector<Candidate>& candidates,
                                const DiagnosisOptions& options) {
  std::vector<std::shared_ptr<const Ingredient>> ingredients;
  for (const auto& candidate : candidates) ingredients.push_back(candidate.ingredient);
  EvaluationOptions out;
  out.pictures = true;
  out.held_out = true;
  out.cancel = options.cancel;
  out.progress = options.progress;
  return workspace.evaluate(fitted.form, fitted.p, out, ingredients);
}

Result<Diagnosis> diagnose_anew(Workspace& workspace, const Fitted& fitted,
                                const DiagnosisOptions& options) {
  Diagnosis out;
  const Scene& scene = *fitted.form.scene;
  std::vector<EffectScore> idle;
  std::vector<Candidate> candidates = collect_candidates(fitted, options, idle);
  auto result = evaluate_for(workspace, fitted, candidates, options);
  if (!result) return failure_of(result);
  Evaluation& evaluation = *result;
  out.floor = measure_floor(scene, evaluation);
  evaluation.measured_weight = measured_weight(out.floor);
  out.held_out_missed = spoils_held_out(fitted, out.floor);
  out.held_out_over = fitted.evaluation.chi(true) > out.floor.limits->floor.at * out.floor.chi;
  const DiagnosisSums sums = diagnosis_sums(evaluation, out.floor);
  const int base = fitted.form.size();
  out.effective_count = sums.effective.count;
  out.whiteness_p = sums.whiteness_p;
  VectorXd mesh_step = tell_of_refined_mesh(fitted, evaluation, sums, out);

  Scored scored = score_photos(fitted.form, std::move(candidates), sums, options);
  if (!scored.null.empty())
    out.gate = scored.null[static_cast<size_t>(out.limits().gate * (scored.null.size() - 1))];
  if (const Candidate* mesh = mesh_candidate(scored.candidates, scored.evidence))
    mesh_step = tell_of_mesh(fitted, evaluation, sums, *mesh, out);
  out.motions = motions_left(scene, evaluation, out.floor, mesh_step);
  score_sensors(sums, base, out.mesh_in_measured, out.limits(), scored);
  for (size_t i = 0; i < scored.candidates.size(); ++i) {
    const auto [at, first] = scored.best.emplace(scored.candidates[i].effect->name(), i);
    if (!first && scored.evidence[i] > scored.evidence[at->second]) at->second = i;
  }

  const Context context{fitted, scene, evaluation, sums, fitted.form.realise(fitted.p), out};
  for (const auto& [name, value] : by_effect(scored.candidates, scored.evidence))
    out.effects.push_back(score_effect(context, scored, scored.best.at(name), value, out));
  find_confusions(sums.effective.H, scored.projected, scored.best, out.limits().confused,
                  out.effects);
  weigh(out.effects);
  std::stable_sort(out.effects.begin(), out.effects.end(), [](const auto& a, const auto& b) {
    return std::pair(a.testable, a.evidence) > std::pair(b.testable, b.evidence);
  });
  displace_leaders(evaluation, scored, out.limits(), out.effects);
  out.effects.insert(out.effects.end(), idle.begin(), idle.end());
  return out;
}

Question question_of_diagnosis(const Fitted& fitted, const DiagnosisOptions& options) {
  Question question = question_of("diagnosis", fitted.form, fitted.p);
  for (const std::string& name : options.without) question.text += "\nwithout " + name;
  for (const Effect* effect : options.also) question.text += "\nalso " + effect->name();
  question.numbers.push_back(
      options.null_simulations.value_or(fitted.form.scene->limits->diagnosis.simulations));
  question.numbers.push_back(options.seed);
  return question;
}

}  // namespace

Result<Diagnosis> diagnose(Workspace& workspace, const Fitted& fitted,
                           const DiagnosisOptions& options) {
  const WorkingAt stage(WorkStage::diagnosis);
  return archived<Diagnosis>(
      {workspace, fitted.form, fitted.p, options.cancel,
       [&] { return question_of_diagnosis(fitted, options); }},
      [&] { return diagnose_anew(workspace, fitted, options); },
      [](const Diagnosis& diagnosis) { return to_archive(diagnosis); },
      [&](const nlohmann::json& known) -> std::optional<Diagnosis> {
        try {
          return diagnosis_from_json(known, realised(fitted), "archive");
        } catch (const InputError&) {
          return {};  // of an effect that is not of the catalogue
        }
      });
}

bool lacks_displaced(const Diagnosis& diagnosis) {
  return std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                     [&](const EffectScore& score) {
                       return is_displaced(score, diagnosis.limits()) && score.displaced.empty();
                     });
}

Result<void> displace_again(Workspace& workspace, const Fitted& fitted,
                            const std::atomic<bool>* cancel, Diagnosis& diagnosis) {
  std::vector<std::shared_ptr<const Ingredient>> ingredients;
  for (const EffectScore& score : diagnosis.effects)
    if (is_displaced(score, diagnosis.limits())) ingredients.push_back(score.best);
  EvaluationOptions options;
  options.held_out = true;
  options.cancel = cancel;
  const auto result = workspace.evaluate(fitted.form, fitted.p, options, ingredients);
  if (!result) return failure_of(result);
  ProjectedHypothesis columns;
  columns.first = columns.base = fitted.form.size();
  for (EffectScore& score : diagnosis.effects) {
    if (!is_displaced(score, diagnosis.limits())) continue;
    displace(*result, columns, score);
    columns.first += score.dof;
  }
  return {};
}

}  // namespace hookeye
