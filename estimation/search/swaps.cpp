#include "estimation/search/swaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/distributions.h"
#include "estimation/effects/catalogue.h"
#include "estimation/fit/ahead.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/extension.h"
#include "estimation/search/refit_score.h"

namespace hookeye {

namespace {

/// Some parameter from `offset` on stands 15 standard errors off its null: 100 in log-likelihood,
/// with which no effect is idle.
bool stands(const Fitted& fitted, Eigen::Index offset, const std::vector<Parameter>& own) {
  for (size_t k = 0; k < own.size(); ++k) {
    const auto i = offset + static_cast<Eigen::Index>(k);
    const double deviation = (fitted.high[i] - fitted.low[i]) / (2.0 * kNormal95);
    if (std::abs(fitted.p[i] - own[k].value) >
        fitted.form.scene->limits->search.stands_deviations * deviation)
      return true;
  }
  return false;
}

}  // namespace

Parted parted_from(const Fitted& fitted, size_t i) {
  Parted out{fitted.form, fitted.form.layout().without(fitted.p, i)};
  out.form.ingredients.erase(out.form.ingredients.begin() + static_cast<std::ptrdiff_t>(i));
  work_out_anew(out.form, out.p);
  return out;
}

namespace {

/// `fitted` without its ingredient `i`, fitted again from where it stands or, where that is nearer,
/// from where the capture's own parameters started: a modulus may have made up for the effect by
/// factors. Coarse to fine where both are far off.
std::optional<Fitted> fit_without(Workspace& workspace, const Fitted& fitted, size_t i,
                                  const FitOptions& options) {
  const auto [form, stands] = parted_from(fitted, i);
  VectorXd told = stands;
  const Eigen::Index own =
      std::min(fitted.form.layout()[i].first, base_form(form.scene).initial().size());
  told.head(own) = form.initial().head(own);
  double least = std::numeric_limits<double>::infinity();
  VectorXd start = stands;
  for (const VectorXd& p : {stands, told}) {
    const auto there = assess(workspace, form, p, options);
    if (there && misfit(*there) < least) least = misfit(*there), start = p;
  }
  FitOptions from_there = options;
  from_there.coarse_to_fine = least > form.scene->limits->search.coarse_again * misfit(fitted);
  auto result = fit(workspace, form, start, from_there);
  if (result) return *std::move(result);
  return {};
}

/// The model without each of these, ahead.
void fit_without_ahead(Workspace& workspace, const Fitted& fitted, const std::vector<size_t>& each,
                       const FitOptions& options) {
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(options);
  for (const size_t i : each)
    tasks.push_back(ahead_task(fmt::format("without {}", i), fitted.form, fitted.p,
                               [&, own, i] { (void)fit_without(workspace, fitted, i, own); }));
  work_ahead(workspace, options.cancel, tasks);
}

}  // namespace

std::optional<Refit> backward(Workspace& workspace, const Fitted& current, const Floor& floor,
                              size_t first_effect, const DiscoverOptions& options) {
  const Yardstick yardstick{&current, &floor, measured_noise2(current)};
  const double full = refit_score(current, yardstick);
  std::vector<size_t> each;
  for (size_t i = first_effect; i + 1 < current.form.ingredients.size(); ++i) {
    const Ingredient& one = *current.form.ingredients[i];
    if (!remeshed_by(one) && !stands(current, current.form.layout()[i].first, one.parameters()))
      each.push_back(i);
  }
  const Workspace::Place here = workspace.place();
  fit_without_ahead(workspace, current, each, options.fit);
  for (const size_t i : each) {
    const Ingredient& one = *current.form.ingredients[i];
    workspace.start_from(here);
    auto lighter = fit_without(workspace, current, i, options.fit);
    if (!lighter) continue;
    const double score = refit_score(*lighter, yardstick), tie = floor.limits->diagnosis.tie;
    if (tell(options.fit.decided, {Asked::dropped,
                                   one.name(),
                                   score > full - tie,
                                   {score - full, -tie, "diagnosis.tie"},
                                   "penalised log likelihood without it over that with it"}))
      return Refit{one.name(), std::move(*lighter), score};
  }
  return {};
}

std::optional<Refit> drop_unsupported(Workspace& workspace, const Fitted& fitted,
                                      const Floor& floor, size_t first_effect,
                                      const DiscoverOptions& options) {
  const auto& all = fitted.form.ingredients;
  if (all.size() < first_effect + 2 || !at_floor(fitted, floor)) return {};
  std::vector<size_t> each;
  for (size_t i = first_effect; i < all.size(); ++i) {
    const auto own = all[i]->parameters();
    const Eigen::Index offset = fitted.form.layout()[i].first;
    bool null = !remeshed_by(*all[i]);
    for (size_t k = 0; k < own.size(); ++k) {
      const auto at = offset + static_cast<Eigen::Index>(k);
      null = null && fitted.low[at] <= own[k].value && own[k].value <= fitted.high[at];
    }
    if (null) each.push_back(i);
  }
  const Workspace::Place here = workspace.place();
  fit_without_ahead(workspace, fitted, each, options.fit);
  for (const size_t i : each) {
    workspace.start_from(here);
    auto lighter = fit_without(workspace, fitted, i, options.fit);
    if (lighter && tell(options.fit.decided,
                        {Asked::dropped,
                         all[i]->name(),
                         at_floor(*lighter, floor),
                         {std::max(lighter->evaluation.chi(false), lighter->evaluation.chi(true)),
                          floor.limits->floor.at * floor.chi, "floor.at"},
                         "its intervals hold its null; the normalised residual without it"}))
      return Refit{all[i]->name(), std::move(*lighter), 0.0};
  }
  return {};
}

bool equals_after_swap(Workspace& workspace, const Fitted& rival, const Fitted& winner,
                       const std::string& dropped, const Floor& floor, const FitOptions& options) {
  const Yardstick yardstick{&winner, &floor, measured_noise2(winner)};
  const double enough = refit_score(winner, yardstick) - floor.limits->diagnosis.tie;
  if (refit_score(rival, yardstick) > enough) return true;
  for (size_t i = 0; i < rival.form.ingredients.size(); ++i)
    if (rival.form.ingredients[i]->name() == dropped) {
      const auto lighter = fit_without(workspace, rival, i, options);
      return lighter && refit_score(*lighter, yardstick) > enough;
    }
  return false;
}

namespace {

bool same_form(const Ingredient& one, const Ingredient& other) {
  return key_of(one) == key_of(other);
}

/// What ties with the leader where `dropped` is not in the model, but for itself.
std::vector<const EffectScore*> doubles_of(const Ingredient& dropped, const Diagnosis& diagnosis) {
  std::vector<const EffectScore*> out;
  for (const EffectScore& score : diagnosis.effects)
    if (nameable(score, diagnosis) && !numerical(score.effect) &&
        score.evidence > diagnosis.effects.front().evidence - diagnosis.limits().tie &&
        (!same_form(*score.best, dropped) || score.other_form))
      out.push_back(&score);
  return out;
}

/// A model without one of its effects, and what the catalogue says of it then.
struct Without {
  const Ingredient& dropped;
  Fitted fitted;
  Diagnosis diagnosis;
};

bool may_leave(const Ingredient& ingredient) {
  return find_effect(ingredient.name()) && !remeshed_by(ingredient);
}

std::optional<Without> diagnosed(Workspace& workspace, const Ingredient& dropped,
                                 std::optional<Fitted> lighter, const DiscoverOptions& options) {
  if (!lighter) return {};
  auto diagnosis = diagnose(workspace, *lighter, options.diagnosis);
  if (!diagnosis) return {};
  return Without{dropped, std::move(*lighter), *std::move(diagnosis)};
}

/// The refit of a swap, announced to who watches. Empty: it failed.
template <class Fit>
std::optional<Refit> told_of_swap(const std::string& in, const std::string& out,
                                  const DiscoverEvents& events, const Fit& fit) {
  const std::string words = in + (in == out ? ", started again" : " in place of " + out);
  auto refitted = announced(events, words, fit);
  if (!refitted) return {};
  return Refit{in, *std::move(refitted), 0.0};
}

std::optional<Refit> in_its_place(Workspace& workspace, const Without& without,
                                  const EffectScore& score, const DiscoverOptions& options,
                                  const DiscoverEvents& events) {
  return told_of_swap(score.effect, without.dropped.name(), events,
                      [&] { return add_effect(workspace, without.fitted, score, options.fit); });
}

/// What swap_for_better() asks of each effect that may leave, ahead.
void swap_ahead(Workspace& workspace, const Fitted& fitted, const std::vector<size_t>& each,
                const RefusedSwaps& refused, const DiscoverOptions& options) {
  std::vector<AheadTask> tasks;
  DiscoverOptions own = options;
  own.fit = untold(options.fit);
  own.diagnosis.progress = nullptr;
  for (const size_t i : each)
    tasks.push_back(ahead_task(fmt::format("swap {}", i), fitted.form, fitted.p, [&, own, i] {
      const Ingredient& dropped = *fitted.form.ingredients[i];
      const auto lighter =
          diagnosed(workspace, dropped, fit_without(workspace, fitted, i, own.fit), own);
      if (!lighter) return;
      for (const EffectScore* score : doubles_of(dropped, lighter->diagnosis))
        if (!refused.contains({ModelKey(fitted.form), key_of(dropped), score->effect}))
          (void)add_effect(workspace, lighter->fitted, *score, own.fit);
    }));
  work_ahead(workspace, options.fit.cancel, tasks);
}

}  // namespace

Step swapped_step(Swap swap) {
  return step_with(std::move(swap.in.effect), std::move(swap.in.fitted), {std::move(swap.out)});
}

std::optional<Swap> swap_for_better(Workspace& workspace, const Fitted& fitted, const Floor& floor,
                                    size_t first_effect, RefusedSwaps& refused,
                                    const DiscoverOptions& options, const DiscoverEvents& events) {
  std::optional<Swap> best;
  if (fitted.form.ingredients.size() < first_effect + 2 || at_floor(fitted, floor)) return best;
  double enough = floor.limits->diagnosis.nameable;
  std::vector<size_t> each;
  for (size_t i = first_effect; i < fitted.form.ingredients.size(); ++i)
    if (may_leave(*fitted.form.ingredients[i])) each.push_back(i);
  const Workspace::Place here = workspace.place();
  swap_ahead(workspace, fitted, each, refused, options);
  for (const size_t i : each) {
    if (best && at_floor(best->in.fitted, floor)) break;
    const Ingredient& dropped = *fitted.form.ingredients[i];
    workspace.start_from(here);
    const auto lighter =
        diagnosed(workspace, dropped, fit_without(workspace, fitted, i, options.fit), options);
    if (!lighter) continue;
    for (const EffectScore* score : doubles_of(dropped, lighter->diagnosis)) {
      const SwapKey asked{ModelKey(fitted.form), key_of(dropped), score->effect};
      if (refused.contains(asked)) continue;
      auto refit = in_its_place(workspace, *lighter, *score, options, events);
      if (!refit) continue;
      refit->score = score_above(refit->fitted, fitted, floor);
      tell(options.fit.decided, {Asked::swapped,
                                 score->effect + " in place of " + dropped.name(),
                                 refit->score >= enough,
                                 {refit->score, enough, "diagnosis.nameable"},
                                 "penalised log likelihood with it over that with the other"});
      if (refit->score < floor.limits->diagnosis.nameable ||
          same_form(*refit->fitted.form.ingredients.back(), dropped))
        refused.emplace(asked, RefusedSwap{refit->fitted.form, refit->fitted.p});
      else if (refit->score >= enough)
        enough = refit->score, best = Swap{dropped.name(), std::move(*refit)};
    }
  }
  return best;
}

namespace {

/// Steps in half-size pictures stall where three times what `last` has over the floor remains: the
/// distance from which nobody in a race came to win (Racer::out_of_reach_of).
bool falls_short(Workspace& workspace, Racer racer, const Racer& last, const TrialScale& scale,
                 const FitOptions& options) {
  const auto far = [&] {
    return racer.structured() > last.limits().out_of_reach * last.structured();
  };
  if (!far()) return false;
  auto followed = follow(workspace, racer.form, racer.trial.p, scale, options);
  if (!followed || !followed->stalled) return false;
  racer.trial = std::move(followed->trial);
  return far();
}

/// Those of `effects` that are within reach of the first of them where it is dropped, or may tie
/// with it where no more is to be had, refitted, if they may come to what `last` leaves.
std::vector<Refit> refit_in_reach(Workspace& workspace, const Without& without, const Fitted& last,
                                  const std::vector<std::string>& effects, bool ties_alone,
                                  const DiscoverOptions& options, const DiscoverEvents& events) {
  std::vector<Refit> out;
  Diagnosis asked = without.diagnosis;
  std::erase_if(asked.effects, [&](const EffectScore& score) {
    return std::find(effects.begin(), effects.end(), score.effect) == effects.end();
  });
  const auto racers = race(workspace, without.fitted, asked, options.fit);
  const auto now = trial_scale(workspace, last.form, last.p, options.fit);
  if (!racers || !now) return out;
  const Racer stands{
      effects.front(), last.form, Trial{last.p, now->chi, now->chi_validate, now->floor}, {}};
  std::vector<const Racer*> near;
  for (const Racer& racer : *racers) {
    const Racer& first = racers->front();
    const bool behind = ties_alone ? !racer.may_tie_with(first) : racer.out_of_reach_of(first);
    if (racer.effect != effects.front() && (!behind || ties_with_first(asked, racer.effect)))
      near.push_back(&racer);
  }
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(options.fit);
  for (const Racer* racer : near)
    tasks.push_back(ahead_task("in reach", racer->form, racer->trial.p, [&, racer] {
      if (!falls_short(workspace, *racer, stands, *now, own)) (void)refit(workspace, *racer, own);
    }));
  const Workspace::Place here = workspace.place();
  work_ahead(workspace, options.fit.cancel, tasks);
  for (const Racer* one : near) {
    const Racer& racer = *one;
    workspace.start_from(here);
    if (falls_short(workspace, racer, stands, *now, options.fit)) continue;
    auto refitted = told_of_swap(racer.effect, effects.front(), events,
                                 [&] { return refit(workspace, racer, options.fit); });
    if (refitted) out.push_back(std::move(*refitted));
  }
  return out;
}

}  // namespace

std::optional<TieAsked> ask_tie_again(Workspace& workspace, const Fitted& last,
                                      const std::vector<std::string>& tie, const Floor& floor,
                                      size_t first_effect, const RefusedSwaps& refused,
                                      const DiscoverOptions& options,
                                      const DiscoverEvents& events) {
  const auto& all = last.form.ingredients;
  size_t i = first_effect;
  while (i < all.size() && all[i]->name() != tie.front()) ++i;
  if (i == all.size() || !may_leave(*all[i])) return {};
  std::vector<Refit> refits;
  std::vector<std::string> open = {tie.front()};
  for (auto rival = tie.begin() + 1; rival != tie.end(); ++rival) {
    const auto known = refused.find({ModelKey(last.form), key_of(*all[i]), *rival});
    if (known == refused.end()) {
      open.push_back(*rival);
      continue;
    }
    auto there = assess(workspace, known->second.form, known->second.p, options.fit);
    if (there) refits.push_back({*rival, *std::move(there), 0.0});
  }
  if (open.size() > 1) {
    // As it stands, what the first explained is what is missing: who equals it explains that.
    const auto [form, stands] = parted_from(last, i);
    auto lighter = assess(workspace, form, stands, options.fit);
    const auto without = diagnosed(
        workspace, *all[i], lighter ? std::optional(*std::move(lighter)) : std::nullopt, options);
    if (!without) return {};
    const bool ties_alone = on_floor(last, floor);
    for (Refit& refit :
         refit_in_reach(workspace, *without, last, open, ties_alone, options, events))
      refits.push_back(std::move(refit));
  }
  TieAsked out;
  for (Refit& refit : refits) {
    refit.score = score_above(refit.fitted, last, floor);
    const double tie_margin = floor.limits->diagnosis.tie;
    if (tell(options.fit.decided, {Asked::tied,
                                   refit.effect,
                                   refit.score > -tie_margin,
                                   {refit.score, -tie_margin, "diagnosis.tie"},
                                   "asked again in place of " + tie.front() +
                                       ": its penalised log likelihood over that one's"}))
      out.tie.push_back(refit.effect);
    if (refit.score > floor.limits->diagnosis.tie &&
        (!out.better || refit.score > out.better->in.score))
      out.better = Swap{tie.front(), std::move(refit)};
  }
  if (out.better)
    out.tie.clear();
  else if (!out.tie.empty())
    out.tie.insert(out.tie.begin(), tie.front());
  return out;
}

}  // namespace hookeye
