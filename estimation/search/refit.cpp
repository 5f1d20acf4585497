#include "estimation/search/refit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/distributions.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/model_key.h"
#include "estimation/search/discover.h"
#include "estimation/search/extension.h"
#include "estimation/search/kept_stiffness.h"
#include "estimation/search/refit_score.h"

namespace hookeye {

namespace {

FitOptions warm(const FitOptions& options) {
  FitOptions out = options;
  out.coarse_to_fine = false;
  return out;
}

/// The refit form of `scored`, when it lives on a mesh of its own. Null: it does not.
std::shared_ptr<const Ingredient> remeshing_form(const Model& model,
                                                 const std::shared_ptr<const Ingredient>& scored,
                                                 const VectorXd& values) {
  auto form = find_effect(scored->name())->refit_form(model, scored, values).form;
  return remeshed_by(*form) ? form : nullptr;
}

/// Fits `model` with `remeshing` on the mesh that it asks for.
Result<Fitted> fit_on_its_mesh(Workspace& workspace, const Model& model,
                               const Ingredient& remeshing, const FitOptions& options) {
  const auto [form, start] = on_its_mesh(model, remeshing);
  FitOptions from_rest = warm(options);  // no equilibrium is known on this mesh
  from_rest.most_iterations = FitOptions{}.most_iterations;
  return fit(workspace, form, start, from_rest);
}

/// `fitted` with another form of its last effect, along that edge. Empty: none leads on.
std::optional<std::pair<ModelForm, VectorXd>> with_other_form(const Fitted& fitted, FormEdge edge) {
  const Ingredient& last = *fitted.form.ingredients.back();
  const ParameterLayout at = fitted.form.layout();
  const VectorXd before = at.before(fitted.p, at.last());
  ModelForm other = fitted.form;
  other.ingredients.pop_back();
  auto next = find_effect(last.name())
                  ->form_from(edge, other.realise(before), last, at.of(fitted.p, at.last()));
  if (!next) return std::nullopt;
  VectorXd& values = next->values;
  const auto parameters = next->form->parameters();
  for (int i = 0; i < values.size(); ++i)
    values[i] = std::clamp(values[i], parameters[i].low, parameters[i].high);
  other.ingredients.push_back(std::move(next->form));
  VectorXd there = at.with(fitted.p, at.last(), values);
  there = with_stiffness_of(fitted.form.realise(fitted.p), other, std::move(there));
  return std::pair{std::move(other), std::move(there)};
}

std::string last_in_words(const ModelForm& form) {
  return key_of(*form.ingredients.back()).words();
}

/// One of the last effect's numbers that `plainer` does without is off its null by more than five
/// standard deviations: that is worth 25/2 of log-likelihood, and two numbers cost log N.
bool pays_for_itself(const Fitted& fitted, const Ingredient& plainer) {
  const double deviations = fitted.form.scene->limits->search.kept_deviations;
  const auto kept = plainer.parameters(), all = fitted.form.ingredients.back()->parameters();
  const Eigen::Index first = fitted.p.size() - static_cast<Eigen::Index>(all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    if (std::any_of(kept.begin(), kept.end(), [&](auto& p) { return p.name == all[i].name; }))
      continue;
    const Eigen::Index k = first + static_cast<Eigen::Index>(i);
    const double deviation = 0.5 * (fitted.high[k] - fitted.low[k]) / kNormal95;
    if (std::abs(fitted.p[k] - all[i].value) > deviations * deviation) return true;
  }
  return false;
}

/// The plainer form of the last effect where what it does without does not pay for itself
/// (refit_score), else `fitted`.
Result<Fitted> fit_plainest(Workspace& workspace, Fitted fitted, const FitOptions& options) {
  const auto other = with_other_form(fitted, FormEdge::plainer);
  if (!other || pays_for_itself(fitted, *other->first.ingredients.back())) return fitted;
  auto second = fit(workspace, other->first, other->second, warm(options));
  if (!second) {
    if (cancelled(second.error())) return failure_of(second);
    return fitted;
  }
  const Floor floor = measure_floor(workspace.scene(), fitted.evaluation);
  const Yardstick yardstick{&fitted, &floor, measured_noise2(fitted)};
  const double gain = refit_score(*second, yardstick) - refit_score(fitted, yardstick);
  return tell(options.decided,
              {Asked::widened,
               last_in_words(other->first),
               gain >= 0.0,
               {gain, 0.0, ""},
               "reduced: its penalised log likelihood over that of the form with more numbers"})
             ? second
             : fitted;
}

/// Fits; then the smaller form of the last effect, where it has one, from where the larger ended.
/// The smaller one is kept where it misses no more. The plainer form of either comes last.
Result<Fitted> fit_smallest(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                            const FitOptions& options) {
  auto larger = fit(workspace, form, start, warm(options));
  if (!larger) return larger;
  const auto other = with_other_form(*larger, FormEdge::smaller);
  if (!other) return fit_plainest(workspace, *std::move(larger), options);
  // far from there: coarse to fine
  auto second = fit(workspace, other->first, other->second, options);
  if (!second) {
    if (cancelled(second.error())) return failure_of(second);
    return fit_plainest(workspace, *std::move(larger), options);
  }
  Fitted& smaller = *second;
  const bool as_good = tell(
      options.decided, {Asked::widened,
                        last_in_words(other->first),
                        misfit(smaller) <= misfit(*larger),
                        {misfit(smaller), misfit(*larger), ""},
                        "smaller form: its misfit, fitted and held out, against the larger one's"});
  return fit_plainest(workspace, std::move(as_good ? smaller : *larger), options);
}

}  // namespace

Result<Fitted> add_effect(Workspace& workspace, const Fitted& current, const EffectScore& score,
                          const FitOptions& options) {
  if (score.other_form) {
    const auto scale = trial_scale(workspace, current.form, current.p, options);
    if (!scale) return failure_of(scale);
    const auto entered = enter(workspace, current, score, *scale, options);
    if (entered) return refit(workspace, *entered, options);
    if (cancelled(entered.error())) return failure_of(entered);
  }
  const Model model = current.form.realise(current.p);
  if (auto remeshing = remeshing_form(model, score.best, score.values))
    return fit_on_its_mesh(workspace, model, *remeshing, options);
  return from_shares(current, score, options, [&](const Extension& extension) {
    return fit_smallest(workspace, extension.form, extension.start, options);
  });
}

Result<Fitted> refit(Workspace& workspace, const Racer& racer, const FitOptions& options) {
  const auto& scored = racer.form.ingredients.back();
  const ParameterLayout at = racer.form.layout();
  ModelForm before = racer.form;
  before.ingredients.pop_back();
  const Model model = before.realise(at.before(racer.trial.p, at.last()));
  if (auto remeshing = remeshing_form(model, scored, at.of(racer.trial.p, at.last())))
    return fit_on_its_mesh(workspace, model, *remeshing, options);
  return fit_smallest(workspace, racer.form, racer.trial.p, options);
}

}  // namespace hookeye
