#include "estimation/widening.h"

#include <algorithm>
#include <set>

namespace hookeye {

namespace {

double misfit(const Fitted& fitted) {
  return fitted.evaluation.chi(false) + fitted.evaluation.chi(true);
}

bool cancelled(const NumericalFailure& failure) { return failure.reason == "cancelled"; }

/// The further forms of the last effect of `fitted`.
std::vector<Effect::Further> further_forms(const Fitted& fitted) {
  const Ingredient& last = *fitted.form.ingredients.back();
  const Effect* effect = find_effect(last.name());
  if (!effect) return {};
  const auto own = static_cast<Eigen::Index>(last.parameters().size());
  ModelForm before = fitted.form;
  before.ingredients.pop_back();
  const auto rest = fitted.p.size() - own;
  return effect->further_forms(before.realise(fitted.p.head(rest)), last, fitted.p.tail(own));
}

std::variant<Fitted, NumericalFailure> fit_in(Workspace& workspace, const Fitted& narrow,
                                              const Effect::Further& further,
                                              const FitOptions& options) {
  const auto own = static_cast<Eigen::Index>(narrow.form.ingredients.back()->parameters().size());
  ModelForm form = narrow.form;
  form.ingredients.back() = further.form;
  VectorXd start(narrow.p.size() - own + further.values.size());
  start << narrow.p.head(narrow.p.size() - own), further.values;
  const auto parameters = form.parameters();
  for (Eigen::Index i = 0; i < start.size(); ++i)
    start[i] = std::clamp(start[i], parameters[i].low, parameters[i].high);
  // From farther off than twice the narrow form's misfit, motions may be beyond full-size pictures.
  const auto there = assess(workspace, form, start, options);
  if (const auto* failure = std::get_if<NumericalFailure>(&there)) return *failure;
  FitOptions from_there = options;
  from_there.coarse_to_fine = misfit(std::get<Fitted>(there)) > 2.0 * misfit(narrow);
  return fit(workspace, form, start, from_there);
}

bool pays(const Fitted& wide, const Fitted& narrow, const Floor& floor) {
  const Fitted& reference = misfit(wide) < misfit(narrow) ? wide : narrow;
  const double noise2 = std::min(measured_noise2(wide), measured_noise2(narrow));
  const Yardstick yardstick{&reference, &floor, noise2};
  return refit_score(wide, yardstick) > refit_score(narrow, yardstick) + kTie &&
         held_out_allows(wide, narrow, floor);
}

}  // namespace

std::variant<Fitted, NumericalFailure> widened(Workspace& workspace, Fitted narrow,
                                               const Floor& floor, const FitOptions& options,
                                               const DiscoverEvents& events) {
  std::set<std::string> tried = {narrow.form.ingredients.back()->variant()};
  for (bool better = true; better && !at_floor(narrow, floor, kLeftByRenderers);) {
    better = false;
    Fitted best = narrow;
    for (const auto& further : further_forms(narrow)) {
      if (!tried.insert(further.form->variant()).second) continue;
      if (better && at_floor(best, floor, kLeftByRenderers)) break;
      const std::string words = further.form->name() + " as '" + further.form->variant() + "'";
      if (events.refitting) events.refitting(words);
      auto result = fit_in(workspace, narrow, further, options);
      if (auto* failure = std::get_if<NumericalFailure>(&result)) {
        if (cancelled(*failure)) return *failure;
        continue;
      }
      Fitted& wide = std::get<Fitted>(result);
      if (events.refitted) events.refitted(words, wide);
      if (!pays(wide, best, floor)) continue;
      best = std::move(wide);
      better = true;
    }
    narrow = std::move(best);
  }
  return narrow;
}

std::optional<NumericalFailure> widen(Workspace& workspace, std::vector<Refit>& refits,
                                      const Floor& floor, const DiscoverOptions& options,
                                      const DiscoverEvents& events) {
  std::vector<Refit*> order;
  for (Refit& refit : refits) order.push_back(&refit);
  std::stable_sort(order.begin(), order.end(), [](const Refit* a, const Refit* b) {
    return misfit(a->fitted) < misfit(b->fitted);
  });
  if (order.empty()) return {};
  const double most = 3.0 * misfit(order.front()->fitted);
  for (Refit* refit : order) {
    if (std::any_of(refits.begin(), refits.end(), [&](const Refit& one) {
          return at_floor(one.fitted, floor, kLeftByRenderers);
        }))
      break;
    if (misfit(refit->fitted) > most) continue;
    auto wide = widened(workspace, refit->fitted, floor, options.fit, events);
    if (auto* failure = std::get_if<NumericalFailure>(&wide)) return *failure;
    refit->fitted = std::get<Fitted>(std::move(wide));
  }
  return {};
}

}  // namespace hookeye
