#include "estimation/search/race.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "capture_io/seen_in_words.h"
#include "estimation/fit/ahead.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/extension.h"

namespace hookeye {

namespace {

/// After its second step (run_ahead: or a later one), or where it stands if there is none.
const Trial& newest(const Racer& racer) { return racer.next ? *racer.next : racer.trial; }

/// Which of two forms of an effect gets farther on fitted and held-out photos together; one that
/// takes from the fitted ones not half of what the other does gets nowhere, and has spoilt no
/// held-out photo for that alone.
bool gets_farther(const Racer& one, const Racer& other, const TrialScale& scale) {
  const auto taken = [&](const Racer& racer) {
    return scale.chi * scale.chi - std::pow(newest(racer).chi_fit, 2);
  };
  const double least = one.limits().farther;
  if (taken(one) < least * taken(other)) return false;
  if (taken(other) < least * taken(one)) return true;
  const auto chi = [](const Racer& racer) {
    return newest(racer).chi_fit + newest(racer).chi_validate;
  };
  return chi(one) < chi(other);
}

/// The racer with `won` before its effect, at the null or where a form without a way back to it
/// starts. `before`: what both were scored on.
Racer joined_by(const Racer& alone, const Fitted& before, const EffectScore& won) {
  Model model = alone.form.realise(alone.trial.p);
  model.states = realised(before).states;
  auto [ingredient, values] = entering(model, won, 0.0);
  Racer both = alone;
  both.next.reset();
  const ParameterLayout at = alone.form.layout();
  both.form.ingredients.insert(both.form.ingredients.end() - 1, std::move(ingredient));
  const VectorXd& p = alone.trial.p;
  both.trial.p.resize(p.size() + values.size());
  both.trial.p << at.before(p, at.last()), values, at.of(p, at.last());
  return both;
}

/// Steps once more from where the racer stands.
Result<Trial> step_on(Workspace& workspace, const Racer& racer, const TrialScale& scale,
                      const FitOptions& options) {
  if (racer.next) return *racer.next;
  return try_step(workspace, racer.form, racer.trial.p, scale, options);
}
/// The racer's second step, where there is one.
Result<void> run_on(Workspace& workspace, Racer& racer, const TrialScale& scale,
                    const FitOptions& options, const std::function<void(const Racer&)>& tried) {
  auto result = step_on(workspace, racer, scale, options);
  if (!result) {
    if (cancelled(result.error())) return failure_of(result);
    return {};
  }
  racer.trial = *std::move(result);
  if (tried) tried(racer);
  return {};
}

void sort_by_success(std::vector<Racer>& racers) {
  std::stable_sort(racers.begin(), racers.end(),
                   [](const Racer& a, const Racer& b) { return a.chi() < b.chi(); });
}

/// Photos of `left` keep at most a tenth of what `start` had over the floor, fitted and held-out.
bool explains_nearly_all(const Trial& left, const TrialScale& start, const SearchLimits& limits) {
  const double floor2 = start.floor * start.floor;
  const auto nearly = [&](double after, double before) {
    return after * after - floor2 <= limits.nearly_all * std::max(0.0, before * before - floor2);
  };
  return nearly(left.chi_fit, start.chi) && nearly(left.chi_validate, start.chi_validate);
}

/// The first takes its second step before the others their first, and more while they bring it to
/// where it explains nearly all: who need not run shows then.
Result<void> run_ahead(Workspace& workspace, Racer& first, const TrialScale& start,
                       const FitOptions& options) {
  for (int step = 1; step < kMostTrials; ++step) {
    const Trial before = step == 1 ? first.trial : *first.next;
    if (step > 1 || !first.next) {  // of two forms it may have taken it already
      auto further = try_step(workspace, first.form, before.p, start, options);
      if (!further) {
        if (cancelled(further.error())) return failure_of(further);
        return {};
      }
      first.next = *std::move(further);
    }
    if (!brings_nearly_all(before, *first.next, start, first.limits())) return {};
  }
  return {};
}

}  // namespace

bool brings_nearly_all(const Trial& before, const Trial& now, const TrialScale& start,
                       const SearchLimits& limits) {
  const auto over = [&](double chi) {
    return std::max(0.0, chi * chi - start.floor * start.floor);
  };
  const auto brings = [&](double at_start, double then, double left) {
    const double most = limits.nearly_all * over(at_start);
    return over(left) <= most || over(left) * over(left) <= most * over(then);
  };
  return !explains_nearly_all(now, start, limits) &&
         brings(start.chi, before.chi_fit, now.chi_fit) &&
         brings(start.chi_validate, before.chi_validate, now.chi_validate);
}

namespace {

/// The first explains nearly all, and this one promises less than half of what the first did and
/// would be out of its reach with that: it could only come from there to tie, as a double whose
/// first step does not look like it. Not asked of what moves no photo.
bool no_rival(const EffectScore& score, const Diagnosis& diagnosis, const Racer& first,
              const TrialScale& start) {
  const EffectScore& led = diagnosis.effects.front();
  if (first.effect != led.effect || !explains_nearly_all(newest(first), start, first.limits()) ||
      sensors_alone(*score.best) || ties_with_first(diagnosis, score.effect) ||
      score.explains > first.limits().promises * led.explains)
    return false;
  const double chi2 = start.chi * start.chi, floor2 = start.floor * start.floor;
  return std::sqrt(chi2 - score.explains * (chi2 - floor2)) >
         first.limits().out_of_reach * newest(first).chi_fit;
}

/// 0: there is none.
std::string residual_in_words(double chi) { return chi > 0.0 ? fmt::format("{:.3g}", chi) : "-"; }

void tell_of_trial(const FitOptions& options, const Racer& racer, const TrialScale& start) {
  const Capture& capture = racer.form.scene->capture;
  const std::string half = on_half_size(capture);
  tell(options.decided,
       {Asked::screened,
        racer.effect,
        true,
        {racer.chi(), start.chi + start.chi_validate, ""},
        fmt::format("one step of its refit{}: normalised residual {} on fitted {}, {} on held-out "
                    "ones; without it {} and {}; noise floor {}",
                    half.empty() ? half : "," + half, residual_in_words(racer.trial.chi_fit),
                    seen_in_words(capture), residual_in_words(racer.trial.chi_validate),
                    residual_in_words(start.chi), residual_in_words(start.chi_validate),
                    start.floor > 0.0 ? residual_in_words(start.floor) : "unknown")});
}

}  // namespace

bool ties_with_first(const Diagnosis& diagnosis, const std::string& effect) {
  return std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const auto& score) {
    return score.effect == effect &&
           score.evidence > diagnosis.effects.front().evidence - diagnosis.limits().tie;
  });
}

bool leads(const Diagnosis& diagnosis, const EffectScore& score) {
  if (numerical(score.effect) || !nameable(score, diagnosis)) return false;
  double most = score.evidence;
  for (const EffectScore& other : diagnosis.effects)
    if (!numerical(other.effect) && nameable(other, diagnosis))
      most = std::max(most, other.evidence);
  return score.evidence > most - diagnosis.limits().tie;
}

bool Racer::at_floor() const {
  const double most = form.scene->limits->floor.at * trial.floor;
  return trial.chi_fit <= most && trial.chi_validate <= most;
}

double Racer::structured() const {
  const double f2 = trial.floor * trial.floor;
  const double least = std::pow(form.scene->limits->floor.on, 2) - 1.0;
  const auto over = [&](double chi) { return std::sqrt(std::max(chi * chi - f2, least * f2)); };
  return over(trial.chi_fit) + (trial.chi_validate > 0.0 ? over(trial.chi_validate) : 0.0);
}

Result<Racer> enter(Workspace& workspace, const Fitted& current, const EffectScore& score,
                    const TrialScale& scale, const FitOptions& options) {
  Result<Racer> best = no_result({"", 0.0, "no start"});
  for (const EffectScore* form : {&score, score.other_form.get()}) {
    if (!form) continue;
    ModelForm started;
    TrialScale own = scale;
    // There the first step may begin worse than the model without, and what it leaves decides.
    if (starts_anywhere(current, *form)) own.chi = std::numeric_limits<double>::infinity();
    auto result = from_shares(current, *form, options, [&](const Extension& extension) {
      started = extension.form;
      return try_step(workspace, started, extension.start, own, options);
    });
    if (!result) {
      if (form == &score || cancelled(result.error())) best = failure_of(result);
      if (cancelled(result.error())) break;
      continue;
    }
    Racer racer{score.effect, std::move(started), *std::move(result), {}, scale};
    if (best)
      for (Racer* one : {&*best, &racer}) {
        auto further = step_on(workspace, *one, scale, options);
        if (!further) {
          if (cancelled(further.error())) return failure_of(further);
        } else {
          one->next = *std::move(further);
        }
      }
    if (!best || gets_farther(racer, *best, scale)) best = std::move(racer);
  }
  return best;
}

namespace {

/// What enters a race, its first steps ahead. With the `first`, who runs ahead, it shows whether
/// the others need not run; before, all are taken to.
void enter_ahead(Workspace& workspace, const Fitted& current, const Diagnosis& diagnosis,
                 const TrialScale& scale, const FitOptions& options, const Racer* first) {
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(options);
  for (const EffectScore& score : diagnosis.effects) {
    if (!nameable(score, diagnosis) || (first && no_rival(score, diagnosis, *first, scale)))
      continue;
    const bool leads = tasks.empty() && !first && &score != &diagnosis.effects.back();
    tasks.push_back(ahead_task("enter " + score.effect, current.form, current.p, [&, own, leads] {
      auto entered = enter(workspace, current, score, scale, own);
      if (entered && leads) run_ahead(workspace, *entered, scale, own);
    }));
  }
  work_ahead(workspace, options.cancel, tasks, !first);
}

/// The same of steps of racers; those that have had theirs are left out.
void step_ahead(Workspace& workspace, const std::vector<const Racer*>& racers,
                const TrialScale& scale, const FitOptions& options) {
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(options);
  for (const Racer* racer : racers)
    if (!racer->next)
      tasks.push_back(ahead_task("step", racer->form, racer->trial.p, [&, own, racer] {
        (void)try_step(workspace, racer->form, racer->trial.p, scale, own);
      }));
  work_ahead(workspace, options.cancel, tasks);
}

/// Why the racer at this place has no second step. Empty: it has one. What the evidence puts first
/// is refitted whatever comes: one step from afar may mislead.
std::optional<Decision> without_second_step(const std::vector<Racer>& racers, size_t i,
                                            const Racer& first, const Diagnosis& diagnosis) {
  const std::string& effect = racers[i].effect;
  if (effect == diagnosis.effects.front().effect) return {};
  const SearchLimits& limits = first.limits();
  if (static_cast<int>(i) >= limits.second_round)
    return Decision{Asked::screened,
                    effect,
                    false,
                    {double(i + 1), double(limits.second_round), "search.second_round"},
                    "other effects got farther in their first step: no second one"};
  if (racers[i].out_of_reach_of(first) && !ties_with_first(diagnosis, effect))
    return Decision{Asked::screened,
                    effect,
                    false,
                    {racers[i].chi(), limits.out_of_reach * first.chi(), "search.out_of_reach"},
                    "after one step too far behind " + first.effect + ": no second one"};
  return {};
}

}  // namespace

Result<std::vector<Racer>> race(Workspace& workspace, const Fitted& current,
                                const Diagnosis& diagnosis, const FitOptions& options,
                                const std::function<void(const Racer&)>& tried) {
  std::vector<Racer> racers;
  const auto scale = trial_scale(workspace, current.form, current.p, options);
  if (!scale) return failure_of(scale);
  enter_ahead(workspace, current, diagnosis, *scale, options, nullptr);
  for (const EffectScore& score : diagnosis.effects) {
    if (!nameable(score, diagnosis)) continue;
    if (!racers.empty() && no_rival(score, diagnosis, racers.front(), *scale)) {
      tell(options.decided,
           {Asked::screened,
            score.effect,
            false,
            {score.explains, racers.front().limits().promises * diagnosis.effects.front().explains,
             "search.promises"},
            racers.front().effect +
                " explains nearly all, and this promises too little to equal it"});
      continue;
    }
    auto entered = enter(workspace, current, score, *scale, options);
    if (!entered) {
      if (cancelled(entered.error())) return failure_of(entered);
      tell(options.decided, {Asked::screened, score.effect, false, {}, entered.error().reason});
      continue;
    }
    racers.push_back(*std::move(entered));
    tell_of_trial(options, racers.back(), *scale);
    if (tried) tried(racers.back());
    if (racers.size() > 1 || &score == &diagnosis.effects.back()) continue;
    if (auto ran = run_ahead(workspace, racers.front(), *scale, options); !ran)
      return failure_of(ran);
    enter_ahead(workspace, current, diagnosis, *scale, options, &racers.front());
  }
  sort_by_success(racers);
  const Racer first = racers.empty() ? Racer() : racers.front();
  const size_t run = racers.size() > 1 || first.next ? racers.size() : 0;
  std::vector<const Racer*> further;
  for (size_t i = 0; i < run; ++i)
    if (!without_second_step(racers, i, first, diagnosis)) further.push_back(&racers[i]);
  step_ahead(workspace, further, *scale, options);
  for (size_t i = 0; i < run; ++i) {
    if (auto stays = without_second_step(racers, i, first, diagnosis)) {
      tell(options.decided, *std::move(stays));
      continue;
    }
    if (auto ran = run_on(workspace, racers[i], *scale, options, tried); !ran)
      return failure_of(ran);
  }
  sort_by_success(racers);
  return racers;
}

Result<std::vector<Racer>> race_beside(Workspace& workspace, const Fitted& before,
                                       const EffectScore& won, const std::vector<Racer>& racers,
                                       const FitOptions& options,
                                       const std::function<void(const Racer&)>& tried) {
  std::vector<Racer> beside;
  const auto scale = trial_scale(workspace, before.form, before.p, options);
  if (!scale) return failure_of(scale);
  std::vector<Racer> joined;
  for (const Racer& alone : racers) {
    const auto& own = alone.form.ingredients.back();
    if (alone.effect == won.effect || numerical(alone.effect) || sensors_alone(*own)) continue;
    joined.push_back(joined_by(alone, before, won));
  }
  std::vector<const Racer*> all;
  for (const Racer& racer : joined) all.push_back(&racer);
  step_ahead(workspace, all, *scale, options);
  for (Racer& racer : joined) {
    auto result = try_step(workspace, racer.form, racer.trial.p, *scale, options);
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      continue;
    }
    racer.trial = *std::move(result);
    racer.start = *scale;
    if (tried) tried(racer);
    beside.push_back(std::move(racer));
  }
  sort_by_success(beside);
  const auto second = static_cast<size_t>(before.form.scene->limits->search.second_round);
  all.clear();
  for (size_t i = 0; i < std::min(beside.size(), second); ++i) all.push_back(&beside[i]);
  step_ahead(workspace, all, *scale, options);
  for (size_t i = 0; i < std::min(beside.size(), second); ++i) {
    if (auto ran = run_on(workspace, beside[i], *scale, options, tried); !ran)
      return failure_of(ran);
  }
  sort_by_success(beside);
  return beside;
}

}  // namespace hookeye
