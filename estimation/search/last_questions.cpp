#include "estimation/search/last_questions.h"

#include <algorithm>

#include "estimation/search/measured_explained.h"
#include "estimation/search/refit_score.h"
#include "estimation/search/widening.h"

namespace hookeye {

LastAnswer settled_mesh(Workspace& workspace, const Step& newest, const DiscoverOptions& options,
                        const DiscoverEvents& events) {
  if (photos_explained(newest.fitted, newest.diagnosis)) return std::nullopt;
  for (const EffectScore& score : newest.diagnosis.effects) {
    if (!numerical(score.effect) || !score.testable ||
        score.evidence < std::max(newest.diagnosis.limits().nameable, newest.diagnosis.gate))
      continue;
    auto result = announced(events, score.effect, [&] {
      return add_effect(workspace, newest.fitted, score, options.fit);
    });
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      continue;
    }
    Refit refit{score.effect, *std::move(result), 0.0};
    if (told_standing(options.fit.decided, refused_by(newest, refit)))
      return step_with(score.effect, std::move(refit.fitted));
  }
  return std::nullopt;
}

std::optional<Step> without_idle(Workspace& workspace, const Fitted& last, const Floor& floor,
                                 size_t first_effect, const DiscoverOptions& options,
                                 const DiscoverEvents& events) {
  auto lighter = drop_unsupported(workspace, last, floor, first_effect, options);
  if (!lighter)
    lighter = drop_beside_smaller(workspace, last, floor, first_effect, options.fit, events);
  if (!lighter) return {};
  const std::string stands = lighter->fitted.form.ingredients.back()->name();
  return step_with(stands, std::move(lighter->fitted), {stands, lighter->effect});
}

TieAsked contests_again(Workspace& workspace, const std::vector<Step>& steps, size_t first_effect,
                        AskedAgain& asked, const RefusedSwaps& refused,
                        const DiscoverOptions& options, const DiscoverEvents& events) {
  TieAsked out;
  const Fitted& last = steps.back().fitted;
  const auto standing = effects_in(last.form);
  const auto stands = [&](const std::string& effect) {
    return std::find(standing.begin(), standing.end(), effect) != standing.end();
  };
  for (size_t k = 0; k + 1 < steps.size(); ++k) {
    const Step& then = steps[k];
    if (numerical(then.added) || !stands(then.added)) continue;
    std::vector<std::string> contest = {then.added};
    for (const std::string& loser : narrow_losers(then, last))
      if (!stands(loser) && asked.insert({then.added, loser}).second) contest.push_back(loser);
    if (contest.size() < 2) continue;
    auto again = ask_tie_again(workspace, last, contest, steps.back().diagnosis.floor, first_effect,
                               refused, options, events);
    if (!again) continue;
    if (again->better) return std::move(*again);
    if (out.tie.empty()) out.tie = std::move(again->tie);
  }
  return out;
}

LastAnswer wider_loser(Workspace& workspace, const Step& newest, const std::vector<Refit>& losers,
                       const DiscoverOptions& options, const DiscoverEvents& events) {
  const Fitted& last = newest.fitted;
  const Floor& floor = newest.diagnosis.floor;
  if (!spoils_held_out(last, floor)) return std::nullopt;
  for (const Refit& loser : losers) {
    const size_t at = loser.fitted.form.ingredients.size() - 1;
    if (numerical(loser.effect) || !spoils_held_out(loser.fitted, floor) ||
        at + 1 != last.form.ingredients.size())
      continue;
    auto result = widened(workspace, loser.fitted, at, floor, options.fit, events);
    if (!result) return failure_of(result);
    Refit wide{loser.effect, *std::move(result), 0.0};
    const Yardstick yardstick{&wide.fitted, &floor, measured_noise2(wide.fitted)};
    wide.score = refit_score(wide.fitted, yardstick);
    if (wide.score < refit_score(last, yardstick) - newest.diagnosis.limits().tie ||
        held_out_allows(last, wide.fitted, floor))
      continue;
    return swapped_step({newest.added, std::move(wide)});
  }
  return std::nullopt;
}

}  // namespace hookeye
