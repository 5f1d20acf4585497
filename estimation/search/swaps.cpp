#include "estimation/search/swaps.h"

#include <fmt/format.h>

#include <algorithm>

#include "estimation/effects/catalogue.h"
#include "estimation/fit/ahead.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/extension.h"
#include "estimation/search/refit_score.h"
#include "estimation/search/without.h"

namespace hookeye {

Parted parted_from(const Fitted& fitted, size_t i) {
  Parted out{fitted.form, fitted.form.layout().without(fitted.p, i)};
  out.form.ingredients.erase(out.form.ingredients.begin() + static_cast<std::ptrdiff_t>(i));
  work_out_anew(out.form, out.p);
  return out;
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

std::optional<std::pair<const Refit*, Swap>> swap_behind_refit(
    Workspace& workspace, const std::vector<Refit>& refits, const Floor& floor, size_t first_effect,
    RefusedSwaps& refused, const DiscoverOptions& options, const DiscoverEvents& events) {
  if (std::any_of(refits.begin(), refits.end(),
                  [&](const Refit& refit) { return at_floor(refit.fitted, floor); }))
    return {};
  const auto found = std::find_if(refits.begin(), refits.end(), [&](const Refit& refit) {
    return spoils_held_out(refit.fitted, floor);
  });
  if (found == refits.end()) return {};
  auto swap =
      swap_for_better(workspace, found->fitted, floor, first_effect, refused, options, events);
  if (!swap) return {};
  const Yardstick yardstick{&swap->in.fitted, &floor, measured_noise2(swap->in.fitted)};
  swap->in.score = refit_score(swap->in.fitted, yardstick);
  if (std::any_of(refits.begin(), refits.end(), [&](const Refit& refit) {
        return refit_score(refit.fitted, yardstick) >
               swap->in.score - floor.limits->diagnosis.nameable;
      }))
    return {};
  return std::pair{&*found, std::move(*swap)};
}

}  // namespace hookeye
