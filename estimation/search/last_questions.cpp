#include "estimation/search/last_questions.h"

#include <algorithm>
#include <iterator>

#include "estimation/fit/at_floor.h"
#include "estimation/search/measured_explained.h"
#include "estimation/search/refit_score.h"
#include "estimation/search/widening.h"

namespace hookeye {

namespace {

/// Effects that chance does not raise, and that would take what is worth a name beside the model,
/// but may not be added as the mesh's own error may be as large: whoever was named before may stand
/// for one of them, or for the mesh.
std::vector<std::string> stand_out_beside(const Step& last) {
  std::vector<std::string> out;
  const Diagnosis& diagnosis = last.diagnosis;
  const double least = std::max(diagnosis.limits().nameable, diagnosis.gate);
  if (on_floor(last.fitted, diagnosis.floor)) return out;
  for (const EffectScore& score : diagnosis.effects)
    if (score.testable && score.evidence >= least &&
        score.explains >= diagnosis.floor.limits->search.worth_a_name)
      out.push_back(score.effect);
  return out;
}

}  // namespace

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
  const auto beside = stand_out_beside(steps.back());
  const auto stands = [&](const std::string& effect) {
    return std::find(standing.begin(), standing.end(), effect) != standing.end();
  };
  for (size_t k = 0; k < steps.size(); ++k) {
    const Step& then = steps[k];
    if (numerical(then.added) || !stands(then.added)) continue;
    std::vector<std::string> contest = {then.added}, rivals = narrow_losers(then, last);
    // Beside the same others the newest name has been compared with its rivals.
    const bool newest = k + 1 == steps.size();
    if (newest) rivals.clear();
    std::copy_if(beside.begin(), beside.end(), std::back_inserter(rivals), [&](const auto& one) {
      return !newest || std::none_of(then.rivals.begin(), then.rivals.end(),
                                     [&](const Rival& rival) { return rival.effect == one; });
    });
    for (const std::string& rival : rivals)
      if (!stands(rival) && asked.insert({then.added, rival}).second) contest.push_back(rival);
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
