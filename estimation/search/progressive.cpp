#include "estimation/search/progressive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/evidence.h"
#include "estimation/model/additive_material.h"

namespace hookeye {
namespace {

struct Scored {
  size_t index;
  double evidence;
};

/// Refinements by falling log evidence over the present model.
Result<std::vector<Scored>> score(Workspace& workspace, const Fitted& fitted,
                                  const std::vector<Refinement>& all, const FitOptions& options) {
  EvaluationOptions evaluation;
  evaluation.pictures = true;
  evaluation.cancel = options.cancel;
  std::vector<std::shared_ptr<const Ingredient>> candidates;
  for (const Refinement& one : all) candidates.push_back(one.candidate);
  auto result = workspace.evaluate(fitted.form, fitted.p, evaluation, candidates);
  if (!result) return failure_of(result);
  const Evaluation& seen = *result;
  const Floor floor = measure_floor(workspace.scene(), fitted.evaluation);
  const EffectiveSums sums = diagnosis_sums(seen, floor).effective;
  const int base = fitted.form.size();
  std::vector<Scored> out;
  for (size_t i = 0; i < all.size(); ++i) {
    const Parameter t = all[i].candidate->parameters()[0];
    Hypothesis hypothesis;
    hypothesis.first = base + static_cast<int>(i);
    hypothesis.count = 1;
    hypothesis.typical = VectorXd::Constant(1, t.typical);
    hypothesis.one_sided = t.low == 0.0;
    const ProjectedHypothesis projected = project(sums.H, base, hypothesis);
    out.push_back({i, log_evidence(projected, sums.s,
                                   without_base(sums, base, fitted.form.scene->limits->diagnosis),
                                   sums.count, sums.floor2)});
  }
  std::sort(out.begin(), out.end(),
            [](const Scored& a, const Scored& b) { return a.evidence > b.evidence; });
  return out;
}

/// Sum of squares over what is held out; empty where nothing is.
std::optional<double> held_out_misfit(const Fitted& fitted) {
  double sum = 0.0;
  bool any = false;
  for (const auto& example : fitted.evaluation.examples) {
    if (!example.held_out) continue;
    for (const auto& photo : example.photos) sum += photo.r2, any = true;
    for (const auto& measured : example.measured) sum += measured.r.squaredNorm(), any = true;
  }
  return any ? std::optional<double>(sum) : std::nullopt;
}

double fitted_misfit(const Fitted& fitted) { return normal_equations(fitted.evaluation).r2; }

RefinementStage stage_of(const std::string& what, double evidence, const Fitted& fitted) {
  RefinementStage stage;
  stage.what = what;
  stage.evidence = evidence;
  for (const AdditivePart& part : additive_parts(fitted.form, fitted.p))
    stage.values += part.model.size();
  stage.misfit_fit = fitted_misfit(fitted);
  stage.misfit_held_out = held_out_misfit(fitted);
  stage.smallest_eigenvalue = fitted.smallest_eigenvalue;
  return stage;
}

/// What the residual asks for, by falling evidence: functions of one component, and couplings of
/// two; grids of control points only where it asks for none of these. A grid bends as a function of
/// one component would and more, and has many values that other motions then feel.
std::vector<Scored> asked_for(const std::vector<Refinement>& all, const std::vector<Scored>& ranked,
                              const Limits& limits) {
  std::vector<Scored> simple, grids;
  for (const Scored& one : ranked)
    if (one.evidence >= limits.diagnosis.tie) (all[one.index].grid ? grids : simple).push_back(one);
  return simple.empty() ? grids : simple;
}

/// What to fit next, by falling promise: all that the residual asks for at once (a control point at
/// the end of a range bends the middle as well until that has a point of its own), then the two
/// that it asks for most.
struct Next {
  std::string what;
  std::vector<AdditiveModel> models;  ///< of all additive materials
  double evidence;
};
std::vector<Next> next_models(const std::vector<AdditiveModel>& present,
                              const std::vector<Refinement>& all, const std::vector<Scored>& ranked,
                              const Limits& limits) {
  std::vector<Next> out;
  Next together{"", present, 0.0};
  int count = 0;
  for (const Scored& one : asked_for(all, ranked, limits)) {
    if (count == limits.search.refinements_at_once) break;
    const Refinement& refinement = all[one.index];
    refinement.add(together.models[refinement.material]);
    together.what += (count++ ? ", " : "") + refinement.what;
    together.evidence = std::max(together.evidence, one.evidence);
    if (count > 2) continue;
    out.push_back({refinement.what, present, one.evidence});
    refinement.add(out.back().models[refinement.material]);
  }
  if (count > 1) out.insert(out.begin(), std::move(together));
  return out;
}

/// The next model fitted: the first that held-out examples like better than the present one, else
/// the one they like best; without held-out examples the first. Empty where the residual asks for
/// nothing.
Result<std::optional<Fitted>> one_more(Workspace& workspace, const Fitted& present,
                                       const FitOptions& options,
                                       std::vector<RefinementStage>& stages) {
  const std::vector<Refinement> all = refinements(present.form, present);
  if (all.empty()) return std::nullopt;
  auto scored = score(workspace, present, all, options);
  if (!scored) return failure_of(scored);
  const auto before = held_out_misfit(present);
  std::optional<Fitted> best;
  std::vector<AdditiveModel> models;
  for (const AdditivePart& part : additive_parts(present.form, present.p))
    models.push_back(part.model);
  for (const Next& one : next_models(models, all, *scored, *present.form.scene->limits)) {
    const auto [larger, p] = with_structures(present.form, present.p, one.models);
    auto result = fit(workspace, larger, p, options);
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      continue;
    }
    Fitted& next = *result;
    stages.push_back(stage_of(one.what, one.evidence, next));
    const auto after = held_out_misfit(next);
    if (!best || (after && *after < *held_out_misfit(*best))) best = std::move(next);
    if (!before || (after && *after < *before)) break;
  }
  return best;
}

Result<Fitted> best_start(Workspace& workspace, const std::vector<AdditiveStart>& starts,
                          const FitOptions& options) {
  Result<Fitted> best = no_result({"", 0.0, "no start"});
  for (const auto& [form, p] : starts) {
    auto result = fit(workspace, form, p, options);
    if (!result && cancelled(result.error())) return failure_of(result);
    if (!best ||
        (result && normal_equations(result->evaluation).r2 < normal_equations(best->evaluation).r2))
      best = std::move(result);
  }
  return best;
}

}  // namespace

Result<Fitted> fit_progressive(Workspace& workspace, const std::vector<AdditiveStart>& starts,
                               const ProgressiveOptions& options) {
  auto first = best_start(workspace, starts, options.fit);
  if (!first) return first;
  Fitted present = *std::move(first), best = present;
  std::vector<RefinementStage> stages = {stage_of("start", 0.0, best)};
  stages.back().kept = true;
  // A refinement may pay only together with the next, so a refused one is followed further.
  std::vector<size_t> path;  // stages since the best
  for (int round = 0; round < options.most_refinements; ++round) {
    const size_t tried = stages.size();
    auto result = one_more(workspace, present, options.fit, stages);
    if (!result) return failure_of(result);
    auto& next = *result;
    if (!next) break;
    present = std::move(*next);
    const auto held_out = held_out_misfit(present);
    size_t mine = tried;
    while (stages[mine].misfit_held_out != held_out) ++mine;
    path.push_back(mine);
    if (!held_out || *held_out < *held_out_misfit(best)) {
      best = present;
      for (size_t stage : path) stages[stage].kept = true;
      path.clear();
    } else if (static_cast<int>(path.size()) > options.patience) {
      break;
    }
  }
  best.refinements = std::move(stages);
  return best;
}

}  // namespace hookeye
