#include "estimation/search/pairs.h"

#include <algorithm>
#include <utility>

#include "estimation/fit/ahead.h"
#include "estimation/fit/at_floor.h"

namespace hookeye {

namespace {

/// What runs and is refitted beside `first` is told with it.
DiscoverEvents told_with(const std::string& first, const DiscoverEvents& events) {
  DiscoverEvents out = events;
  const auto both = [first](const std::string& effect) { return first + " and " + effect; };
  if (events.tried)
    out.tried = [=](Racer racer) {
      racer.effect = both(racer.effect);
      events.tried(racer);
    };
  if (events.refitting)
    out.refitting = [=](const std::string& effect) { events.refitting(both(effect)); };
  if (events.refitted)
    out.refitted = [=](const std::string& effect, const auto& result) {
      events.refitted(both(effect), result);
    };
  return out;
}

/// The mesh first: nothing is named before it is settled.
Result<std::optional<Pair>> on_finer_mesh(Workspace& workspace, const Step& step, const Refit& best,
                                          const Diagnosis& diagnosis,
                                          const DiscoverOptions& options,
                                          const DiscoverEvents& events) {
  for (const EffectScore& score : diagnosis.effects) {
    if (!numerical(score.effect) || !nameable(score, diagnosis)) continue;
    auto result = announced(events, score.effect,
                            [&] { return add_effect(workspace, best.fitted, score, options.fit); });
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      continue;
    }
    Fitted& both = *result;
    if (!refused_by(step, {best.effect, both, 0.0}))
      return Pair{best, {score.effect, std::move(both), 0.0}};
  }
  return std::nullopt;
}

/// Two refits' effects in one model.
struct Both {
  size_t i, k;
  ModelForm form;
  VectorXd start;
};

std::vector<Both> pairs_of(const std::vector<Refit>& refits) {
  std::vector<Both> out;
  for (size_t i = 0; i < refits.size(); ++i)
    for (size_t k = i + 1; k < refits.size(); ++k) {
      if (numerical(refits[i].effect) || numerical(refits[k].effect)) continue;
      ModelForm form = refits[i].fitted.form;
      form.ingredients.push_back(refits[k].fitted.form.ingredients.back());
      VectorXd p(form.size());
      p << refits[i].fitted.p, refits[k].fitted.p.tail(p.size() - refits[i].fitted.p.size());
      out.push_back({i, k, std::move(form), std::move(p)});
    }
  return out;
}

}  // namespace

Result<std::optional<Pair>> refit_pairs(Workspace& workspace, const Step& step,
                                        const Contest& contest, const DiscoverOptions& options,
                                        const DiscoverEvents& events) {
  std::optional<Pair> best;
  const auto& refits = contest.refits;
  const Yardstick yardstick{&contest.reference, &step.diagnosis.floor, contest.measured_noise2};
  const std::vector<Both> pairs = pairs_of(refits);
  FitOptions warm = options.fit;
  warm.coarse_to_fine = false;
  const Workspace::Place here = workspace.place();
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(warm);
  for (const Both& both : pairs)
    tasks.push_back(ahead_task("pair", both.form, both.start,
                               [&] { (void)fit(workspace, both.form, both.start, own); }));
  work_ahead(workspace, options.fit.cancel, tasks);
  for (const auto& [i, k, form, start] : pairs) {
    workspace.start_from(here);
    auto result =
        announced(events, refits[i].effect + " and " + refits[k].effect,
                  [&, &form = form, &start = start] { return fit(workspace, form, start, warm); });
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      continue;
    }
    auto& fitted = *result;
    const double score = refit_score(fitted, yardstick);
    if (!best || score > best->second.score)
      best = Pair{refits[i], {refits[k].effect, std::move(fitted), score}};
  }
  return best;
}

Result<std::optional<Pair>> refit_beside_best(Workspace& workspace, const Step& step,
                                              const Contest& contest,
                                              const DiscoverOptions& options,
                                              const DiscoverEvents& events) {
  const Refit& best = contest.refits.front();
  const Floor& floor = step.diagnosis.floor;
  if (numerical(best.effect) ||
      over_floor(best.fitted, floor, false) >
          floor.limits->search.pair_takes * over_floor(step.fitted, floor, false) ||
      held_out_allows(best.fitted, step.fitted, floor, least_fall(step.diagnosis, best.effect)))
    return std::nullopt;
  auto diagnosed = diagnose(workspace, best.fitted, options.diagnosis);
  if (!diagnosed) return failure_of(diagnosed);
  Step beside;
  beside.name = beside.added = best.effect;
  beside.fitted = best.fitted;
  beside.diagnosis = *std::move(diagnosed);
  const DiscoverEvents told = told_with(best.effect, events);
  auto on_mesh = on_finer_mesh(workspace, step, best, beside.diagnosis, options, told);
  if (!on_mesh || *on_mesh) return on_mesh;
  std::erase_if(beside.diagnosis.effects,
                [](const EffectScore& score) { return numerical(score.effect); });
  auto refitted = refit_leaders(workspace, beside, {}, options, told);
  if (!refitted) return failure_of(refitted);
  auto& second = *refitted;
  for (Refit& both : second.refits)
    if (!why_refused(beside, second.before, both) &&
        !refused_by(step, {best.effect, both.fitted, 0.0}))
      return Pair{best, std::move(both)};
  return std::nullopt;
}

}  // namespace hookeye
