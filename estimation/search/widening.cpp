#include "estimation/search/widening.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "capture_io/seen_in_words.h"
#include "estimation/effects/catalogue.h"
#include "estimation/fit/ahead.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/extension.h"
#include "estimation/search/kept_stiffness.h"
#include "estimation/search/refit_score.h"
#include "estimation/search/swaps.h"

namespace hookeye {

namespace {

VectorXd values_of(const Fitted& fitted, size_t at) {
  return fitted.form.layout().of(fitted.p, at);
}

/// The model without the ingredient.
Model model_without(const Fitted& fitted, size_t at) {
  const Parted without = parted_from(fitted, at);
  return without.form.realise(without.p);
}

/// The effect's further forms; where others were added after it, first the smaller one, which the
/// refit had asked while they were missing (a stiff place, and what a field took on of a clamp).
std::vector<NextForm> further_forms(const Fitted& fitted, size_t at) {
  const Ingredient& narrow = *fitted.form.ingredients[at];
  const Effect* effect = find_effect(narrow.name());
  if (!effect) return {};
  Model without = model_without(fitted, at);
  without.states = realised(fitted).states;
  const VectorXd own = values_of(fitted, at);
  auto forms = effect->forms_from(FormEdge::further, without, narrow, own);
  if (at + 1 < fitted.form.ingredients.size())
    if (auto smaller = effect->form_from(FormEdge::smaller, without, narrow, own))
      forms.insert(forms.begin(), *std::move(smaller));
  return forms;
}

/// The model with another form of its ingredient, and where to start it.
struct Reformed {
  ModelForm form;
  VectorXd start;
};

Reformed reformed(const Fitted& narrow, size_t at, const NextForm& further) {
  ModelForm form = narrow.form;
  form.ingredients[at] = further.form;
  VectorXd start = narrow.form.layout().with(narrow.p, at, further.values);
  const auto parameters = form.parameters();
  for (Eigen::Index i = 0; i < start.size(); ++i)
    start[i] = std::clamp(start[i], parameters[i].low, parameters[i].high);
  start = with_stiffness_of(narrow.form.realise(narrow.p), form, std::move(start));
  work_out_anew(form, start);
  return {std::move(form), std::move(start)};
}

Result<Fitted> fit_in(Workspace& workspace, const Fitted& narrow, const Reformed& other,
                      const FitOptions& options) {
  // From farther off than twice the narrow form's misfit, motions may be beyond full-size pictures.
  const auto there = assess(workspace, other.form, other.start, options);
  if (!there) return failure_of(there);
  FitOptions from_there = options;
  from_there.coarse_to_fine =
      misfit(*there) > narrow.form.scene->limits->search.coarse_again * misfit(narrow);
  return fit(workspace, other.form, other.start, from_there);
}

double over_floor(const Fitted& fitted, const Floor& floor) {
  return over_floor(fitted, floor, false) + over_floor(fitted, floor, true);
}

/// In the further form; where that starts from another's end, `first` is that one.
Result<Fitted> fit_further(Workspace& workspace, const Fitted& narrow, size_t at,
                           const NextForm& further, const Reformed& first,
                           const FitOptions& options) {
  auto way = fit_in(workspace, narrow, first, options);
  if (!way || !further.by_way_of) return way;
  const Reformed last = reformed(*way, at, {further.form, values_of(*way, at)});
  return fit_in(workspace, narrow, last, options);
}

/// Half-size pictures, where a few steps cost what one does of a fit, show what pays() asks for,
/// with a margin: the steps have stalled and four fifths of what is over the floor are left.
bool gets_nowhere(Workspace& workspace, const Reformed& other, const TrialScale& narrow,
                  const FitOptions& options) {
  if (narrow.floor <= 0.0) return false;
  const auto followed = follow(workspace, other.form, other.start, narrow, options);
  const Trial now{{}, narrow.chi, narrow.chi_validate, narrow.floor};
  return followed && followed->stalled &&
         over_floor(followed->trial) >
             other.form.scene->limits->search.widening_stalls * over_floor(now);
}

/// Half-size pictures show that the steps stall where three times what `now` has over the floor
/// remains, from where nobody in a race came to win (Racer::out_of_reach_of).
bool ends_far_off(Workspace& workspace, const Reformed& other, const TrialScale& now,
                  const FitOptions& options) {
  const auto followed = follow(workspace, other.form, other.start, now, options);
  const auto over = [&](const Trial& trial) {
    return Racer{"", other.form, trial, {}}.structured();
  };
  return followed && followed->stalled &&
         over(followed->trial) > other.form.scene->limits->search.out_of_reach *
                                     over({{}, now.chi, now.chi_validate, now.floor});
}

/// It says more than its parameters cost. Held-out photos speak against it with what they are
/// missed by beyond what renderers leave: by likelihood they tell less than that, as a modulus that
/// moves within its interval changes.
bool worth_its_parameters(const Fitted& wide, const Fitted& narrow, const Floor& floor) {
  return score_above(wide, narrow, floor) > floor.limits->diagnosis.tie &&
         (wide.evaluation.chi(true) <= floor.limits->floor.on * floor.chi ||
          held_out_allows(wide, narrow, floor));
}

/// Most of what was left goes with the form, too: where another effect is missing, a little more
/// than its values cost goes with any.
bool pays(const Fitted& wide, const Fitted& narrow, const Floor& floor, bool same_claim) {
  return (same_claim || over_floor(wide, floor) <
                            floor.limits->search.widening_leaves * over_floor(narrow, floor)) &&
         worth_its_parameters(wide, narrow, floor);
}

bool told_paying(const Decided& decided, const std::string& words, const Fitted& wide,
                 const Fitted& narrow, const Floor& floor, bool same_claim) {
  const double before = over_floor(narrow, floor);
  const double leaves = before > 0.0 ? over_floor(wide, floor) / before : 1.0;
  return tell(
      decided,
      {Asked::widened,
       words,
       pays(wide, narrow, floor, same_claim),
       {leaves, same_claim ? 1.0 : floor.limits->search.widening_leaves, "search.widening_leaves"},
       fmt::format(
           "enriched: the share of the excess misfit that it leaves; penalised log likelihood "
           "{:+.1f}",
           score_above(wide, narrow, floor))});
}

/// Of forms that pay, whatever their order, the one stays that says most.
bool told_ahead(const Decided& decided, const std::string& words, const Fitted& wide,
                const Fitted& best, const Floor& floor) {
  const double ahead = score_above(wide, best, floor);
  return tell(decided, {Asked::widened,
                        words,
                        ahead > 0.0,
                        {ahead, 0.0, ""},
                        "enriched: penalised log likelihood over that of the best form so far"});
}

/// The wide form's plainer one, where it has one that scores as well: all constants of a material
/// that has axes of symmetry.
Result<Fitted> plainest(Workspace& workspace, Fitted wide, size_t at, const Floor& floor,
                        const FitOptions& options, const DiscoverEvents& events) {
  const Ingredient& ingredient = *wide.form.ingredients[at];
  const auto plainer =
      find_effect(ingredient.name())
          ->form_from(FormEdge::plainer, model_without(wide, at), ingredient, values_of(wide, at));
  if (!plainer) return wide;
  const std::string words = key_of(*plainer->form).words();
  auto result = announced(events, words, [&] {
    return fit_in(workspace, wide, reformed(wide, at, *plainer), options);
  });
  if (!result) {
    if (cancelled(result.error())) return failure_of(result);
    return wide;
  }
  const Fitted& plain = *result;
  const Yardstick yardstick{&wide, &floor, std::min(measured_noise2(wide), measured_noise2(plain))};
  return refit_score(plain, yardstick) >= refit_score(wide, yardstick) ? result : wide;
}

}  // namespace

namespace {

/// One of the further forms: how it is called, where it begins, and whether its screening counts.
struct Wider {
  NextForm further;
  std::string words;
  Reformed first;
};

/// Those that were not tried.
std::vector<Wider> wider_forms(const Fitted& narrow, size_t at, std::set<std::string>& tried) {
  std::vector<Wider> out;
  for (const auto& further : further_forms(narrow, at)) {
    const bool again = further.form->variant() == narrow.form.ingredients[at]->variant();
    if (!tried.insert(further.form->variant() + (again ? ", from elsewhere" : "")).second) continue;
    const auto& way = further.by_way_of;
    out.push_back({further, key_of(*further.form).words(),
                   reformed(narrow, at, way ? NextForm{way, further.values} : further)});
  }
  return out;
}

/// Those from `next` on; `options` has what they have to come to by now.
void widen_ahead(Workspace& workspace, const Fitted& narrow, size_t at,
                 const std::vector<Wider>& forms, size_t next, const TrialScale& scale,
                 const FitOptions& options) {
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(options);
  for (size_t i = next; i < forms.size(); ++i) {
    const Wider& one = forms[i];
    tasks.push_back(ahead_task("widen to " + one.words, one.first.form, one.first.start, [&, own] {
      if (one.further.same_claim || !gets_nowhere(workspace, one.first, scale, own))
        (void)fit_further(workspace, narrow, at, one.further, one.first, own);
    }));
    tasks.back().about.numbers.push_back(own.aim_chi);
  }
  work_ahead(workspace, options.cancel, tasks);
}

/// One round of widened(): the best of the forms that were not tried, `narrow` where none is
/// better.
Result<Fitted> best_form(Workspace& workspace, const Fitted& narrow, size_t at, const Floor& floor,
                         const FitOptions& options, const DiscoverEvents& events,
                         std::set<std::string>& tried, bool& better,
                         std::optional<Fitted>* left_much) {
  const auto scale = trial_scale(workspace, narrow.form, narrow.p, options);
  if (!scale) return failure_of(scale);
  Fitted best = narrow;
  const std::vector<Wider> forms = wider_forms(narrow, at, tried);
  const Workspace::Place here = workspace.place();
  for (size_t i = 0; i < forms.size(); ++i) {
    const auto& [further, words, first] = forms[i];
    if (better && on_floor(best, floor)) break;
    FitOptions farther = options;
    farther.aim_chi = best.evaluation.chi(false);  // one that does not get there is no better
    workspace.start_from(here);
    widen_ahead(workspace, narrow, at, forms, i, *scale, farther);
    if (!further.same_claim && gets_nowhere(workspace, first, *scale, options)) {
      tell(options.decided,
           {Asked::widened,
            words,
            false,
            {std::numeric_limits<double>::quiet_NaN(),
             narrow.form.scene->limits->search.widening_stalls, "search.widening_stalls"},
            fmt::format("its screening{} stalls with most of the excess misfit",
                        on_half_size(narrow.form.scene->capture))});
      continue;
    }
    auto result = announced(events, words, [&, &further = further, &first = first] {
      return fit_further(workspace, narrow, at, further, first, farther);
    });
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      tell(options.decided, {Asked::widened, words, false, {}, result.error().reason});
      continue;
    }
    Fitted& wide = *result;
    const bool paid = told_paying(options.decided, words, wide, narrow, floor, further.same_claim);
    if (!paid || (better && !told_ahead(options.decided, words, wide, best, floor))) {
      if (left_much && worth_its_parameters(wide, best, floor) &&
          (!*left_much || score_above(wide, **left_much, floor) > 0.0)) {
        drop_pictures(wide);
        *left_much = std::move(wide);
      }
      continue;
    }
    best = std::move(wide);
    better = true;
  }
  return best;
}

}  // namespace

Result<Fitted> widened(Workspace& workspace, Fitted narrow, size_t at, const Floor& floor,
                       const FitOptions& options, const DiscoverEvents& events,
                       std::optional<Fitted>* left_much, bool another_stands_out) {
  const std::string first = narrow.form.ingredients[at]->variant();
  std::set<std::string> tried = {first};
  bool go_on = another_stands_out || !on_floor(narrow, floor);
  while (go_on) {
    bool better = false;
    auto best = best_form(workspace, narrow, at, floor, options, events, tried, better, left_much);
    if (!best) return failure_of(best);
    narrow = *std::move(best);
    go_on = better && !on_floor(narrow, floor);
  }
  if (narrow.form.ingredients[at]->variant() == first && !on_floor(narrow, floor)) return narrow;
  return plainest(workspace, std::move(narrow), at, floor, options, events);
}

Result<std::optional<Fitted>> WiderForms::ask(const Fitted& fitted, size_t at, const Floor& floor,
                                              bool another_stands_out) {
  const FormKey narrow = key_of(*fitted.form.ingredients[at]);
  if (!asked_.insert({ModelKey(fitted.form), narrow}).second) return std::nullopt;
  std::optional<Fitted> left_much;
  auto result =
      widened(workspace_, fitted, at, floor, options_, events_, &left_much, another_stands_out);
  if (!result) return failure_of(result);
  if (left_much) left_much_.push_back({ModelKey(fitted.form), at, std::move(*left_much)});
  Fitted& wide = *result;
  const FormKey form = key_of(*wide.form.ingredients[at]);
  if (form == narrow && wide.p == fitted.p) return std::nullopt;
  came_to_.insert(form);
  return std::move(wide);
}

Result<std::optional<Fitted>> WiderForms::instead_of(const Refit& winner, const Fitted& now,
                                                     const Floor& floor) {
  std::optional<Fitted> best;
  size_t at = 0;
  const ModelKey asked(now.form);
  for (LeftMuch& one : left_much_)
    if (one.asked == asked && (!best || score_above(one.fitted, *best, floor) > 0.0))
      best = one.fitted, at = one.at;
  std::erase_if(left_much_, [&](const LeftMuch& one) { return one.asked == asked; });
  if (!best || numerical(winner.effect)) return std::nullopt;
  const double ahead = score_above(*best, winner.fitted, floor);
  const Ingredient& form = *best->form.ingredients[at];
  if (!tell(options_.decided,
            {Asked::widened,
             key_of(form).words(),
             ahead > 0.0,
             {ahead, 0.0, ""},
             "enriched, in place of " + winner.effect + ": penalised log likelihood over that"}))
    return std::nullopt;
  auto result = plainest(workspace_, std::move(*best), at, floor, options_, events_);
  if (!result) return failure_of(result);
  const Fitted& wide = *result;
  if (ModelKey(wide.form) == asked) return std::nullopt;
  came_to_.insert(key_of(*wide.form.ingredients[at]));
  return *std::move(result);
}

Result<void> WiderForms::mend(Contest& contest, const Step& step, const Floor& floor) {
  auto& refits = contest.refits;
  const auto spoiler = std::find_if(refits.begin(), refits.end(), [&](const Refit& refit) {
    return spoils_held_out(refit.fitted, floor) && !numerical(refit.effect);
  });
  if (spoiler == refits.end() || std::any_of(refits.begin(), refits.end(), [&](const Refit& refit) {
        return at_floor(refit.fitted, floor);
      }))
    return {};
  auto result = ask(spoiler->fitted, spoiler->fitted.form.ingredients.size() - 1, floor);
  if (!result) return failure_of(result);
  if (auto& wide = *result) {
    spoiler->fitted = std::move(*wide);
    rank(contest, step);
  }
  return {};
}

Result<void> WiderForms::ask_leaders(Contest& contest, const Step& step, const Floor& floor) {
  const std::string winner = contest.refits.front().effect;
  if (numerical(winner)) return {};
  bool any = false;
  for (Refit& refit : contest.refits) {
    const bool leading = std::any_of(
        step.diagnosis.effects.begin(), step.diagnosis.effects.end(), [&](const auto& score) {
          return score.effect == refit.effect && leads(step.diagnosis, score);
        });
    if (!leading || refit.effect == winner) continue;
    auto result = ask(refit.fitted, refit.fitted.form.ingredients.size() - 1, floor);
    if (!result) return failure_of(result);
    if (auto& wide = *result) refit.fitted = std::move(*wide), any = true;
  }
  if (any) rank(contest, step);
  return {};
}

std::optional<Refit> drop_beside_smaller(Workspace& workspace, const Fitted& fitted,
                                         const Floor& floor, size_t first_effect,
                                         const FitOptions& options, const DiscoverEvents& events) {
  const auto& all = fitted.form.ingredients;
  if (all.size() < first_effect + 2 || !at_floor(fitted, floor)) return {};
  const auto now = trial_scale(workspace, fitted.form, fitted.p, options);
  if (!now) return {};
  for (size_t i = first_effect; i < all.size(); ++i) {
    if (!find_effect(all[i]->name()) || remeshed_by(*all[i])) continue;
    Fitted without = fitted;
    const Parted rest = parted_from(fitted, i);
    without.form = rest.form, without.p = rest.p;
    for (size_t at = first_effect; at < rest.form.ingredients.size(); ++at) {
      const Ingredient& larger = *rest.form.ingredients[at];
      const Effect* effect = find_effect(larger.name());
      if (!effect) continue;  // no effect of the catalogue: a placebo
      const auto smaller = effect->form_from(FormEdge::smaller, model_without(without, at), larger,
                                             values_of(without, at));
      if (!smaller) continue;
      const std::string words = key_of(*smaller->form).words() + " without " + all[i]->name();
      const Reformed other = reformed(without, at, *smaller);
      if (ends_far_off(workspace, other, *now, options)) continue;
      auto lighter =
          announced(events, words, [&] { return fit_in(workspace, without, other, options); });
      if (!lighter) continue;
      const double score = score_above(*lighter, fitted, floor), tie = floor.limits->diagnosis.tie;
      if (tell(options.decided,
               {Asked::dropped,
                all[i]->name(),
                at_floor(*lighter, floor) && score > -tie,
                {score, -tie, "diagnosis.tie"},
                "beside a smaller form: penalised log likelihood " + words + " over that with it"}))
        return Refit{all[i]->name(), *std::move(lighter), 0.0};
    }
  }
  return {};
}

bool WiderForms::came_to(const Ingredient& form) const { return came_to_.contains(key_of(form)); }

}  // namespace hookeye
