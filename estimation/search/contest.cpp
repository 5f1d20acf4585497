#include "estimation/search/contest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "capture_io/seen_in_words.h"
#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/fit/ahead.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/evidence.h"
#include "estimation/search/mesh_first.h"
#include "estimation/search/refit_score.h"
#include "estimation/search/without.h"

namespace hookeye {

Step step_with(std::string effect, Fitted fitted, std::vector<std::string> dropped) {
  Step step;
  step.name = step.added = std::move(effect);
  step.dropped = std::move(dropped);
  step.fitted = std::move(fitted);
  return step;
}

void drop_pictures(Fitted& fitted) {
  for (ExampleEvaluation& example : fitted.evaluation.examples)
    for (PhotoEvaluation& photo : example.photos) {
      photo.model = Image();
      photo.residual = Image();
      photo.triangle = std::vector<int>();
    }
}

namespace {

/// The first `most` of a race and the effect of the largest evidence: who is slow in two steps may
/// still be right. So may a sensor's error, which moves no photo and so cannot win by them. A
/// numerical error that comes near the first is refitted too, whatever its rank, where it may be
/// all there is: nothing is named before the mesh is settled. Where nobody is ahead of it it goes
/// first, however far it got.
void keep_leaders(std::vector<Racer>& racers, const Diagnosis& diagnosis, int most,
                  const Decided& decided) {
  if (racers.empty()) return;
  const std::string& first = diagnosis.effects.front().effect;
  const Racer winner = racers.front();
  std::vector<Racer> kept;
  const EffectScore* mesh = mesh_ahead(diagnosis);
  const auto leading = [&](const std::string& effect) {
    return std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const auto& score) {
      return score.effect == effect && leads(diagnosis, score);
    });
  };
  int places = most;
  for (size_t i = 0; i < racers.size() && static_cast<int>(i) < most; ++i)
    places -= racers[i].effect == first || leading(racers[i].effect);
  for (Racer& racer : racers) {
    const bool held = racer.effect == first || (mesh && racer.effect == mesh->effect) ||
                      leading(racer.effect) || sensors_alone(*racer.form.ingredients.back());
    if (!held && !ties_with_first(diagnosis, racer.effect) && racer.out_of_reach_of(winner)) {
      tell(decided,
           {Asked::refitted,
            racer.effect,
            false,
            {racer.chi(), winner.limits().out_of_reach * winner.chi(), "search.out_of_reach"},
            "after as many steps too far behind " + winner.effect});
      continue;
    }
    if (held || places-- > 0 || (may_be_all(racer.effect, diagnosis) && racer.may_tie_with(winner)))
      kept.push_back(std::move(racer));
    else
      tell(decided, {Asked::refitted,
                     racer.effect,
                     false,
                     {racer.chi(), winner.chi(), "search.leaders"},
                     fmt::format("{} others got farther in the screening", most)});
  }
  racers = std::move(kept);
  if (mesh)
    std::stable_partition(racers.begin(), racers.end(),
                          [&](const Racer& racer) { return racer.effect == mesh->effect; });
}

/// Adds to `racers` those that get farther beside the newest effect from where they stood before
/// it was added; of one effect the better start runs on.
Result<void> let_beaten_run(Workspace& workspace, const Beaten& beaten,
                            const DiscoverOptions& options, const DiscoverEvents& events,
                            std::vector<Racer>& racers) {
  const auto& scores = beaten.before.diagnosis.effects;
  const auto won = std::find_if(scores.begin(), scores.end(),
                                [&](const auto& score) { return score.effect == beaten.winner; });
  if (won == scores.end()) return {};
  auto beside =
      race_beside(workspace, beaten.before.fitted, *won, beaten.racers, options.fit, events.tried);
  if (!beside) return failure_of(beside);
  for (Racer& racer : *beside) {
    const auto same = std::find_if(racers.begin(), racers.end(), [&](const Racer& other) {
      return other.effect == racer.effect;
    });
    if (same == racers.end())
      racers.push_back(std::move(racer));
    else if (racer.chi() < same->chi())
      *same = std::move(racer);
  }
  std::stable_sort(racers.begin(), racers.end(),
                   [](const Racer& a, const Racer& b) { return a.chi() < b.chi(); });
  return {};
}

}  // namespace

void LastContest::won(std::string winner, size_t step, std::vector<Racer> racers) {
  winner_ = std::move(winner), step_ = step, racers_ = std::move(racers);
}

std::optional<Beaten> LastContest::beaten(const std::vector<Step>& steps) const {
  if (racers_.empty()) return {};
  const ModelForm &grown = steps.back().fitted.form, &form = steps[step_].fitted.form;
  if (grown.scene != form.scene || grown.ingredients.size() != form.ingredients.size() + 1 ||
      grown.ingredients.back()->name() != winner_ ||
      !std::equal(form.ingredients.begin(), form.ingredients.end(), grown.ingredients.begin()))
    return {};
  return Beaten{steps[step_], winner_, racers_};
}

std::vector<Raced> raced(const std::vector<Racer>& racers) {
  std::vector<Raced> out;
  for (const Racer& racer : racers)
    out.push_back({racer.effect, racer.trial.chi_fit, racer.trial.chi_validate, racer.trial.floor});
  return out;
}

namespace {

/// Nothing can do better than the floor; once it is reached only a tie is of use.
bool of_no_use(const Racer& racer, const Racer& first, const std::vector<Refit>& refits,
               const Floor& floor) {
  return !refits.empty() && on_floor(refits.front().fitted, floor) && !racer.may_tie_with(first);
}

/// The racers from `next` on, with what they have to come to by now. The first of all tells that to
/// the others.
void refit_ahead(Workspace& workspace, const std::vector<Racer>& racers, size_t next,
                 const std::vector<Refit>& refits, const Floor& floor, const FitOptions& fit) {
  if (refits.empty()) return;
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(fit);
  for (size_t i = next; i < racers.size(); ++i) {
    const Racer& racer = racers[i];
    if (of_no_use(racer, racers.front(), refits, floor)) continue;
    tasks.push_back(ahead_task("refit", racer.form, racer.trial.p,
                               [&, own] { (void)refit(workspace, racer, own); }));
    tasks.back().about.numbers.push_back(own.aim_chi);
  }
  work_ahead(workspace, fit.cancel, tasks);
}

/// Whoever leads by evidence and could not be screened (its first step led nowhere) is fitted from
/// coarse to fine all the same.
Result<void> refit_unscreened(Workspace& workspace, const Step& step, const Diagnosis& entered,
                              const DiscoverOptions& options, const DiscoverEvents& events,
                              Contest& out) {
  for (const EffectScore& score : entered.effects) {
    const bool ran = std::any_of(out.racers.begin(), out.racers.end(),
                                 [&](const Racer& racer) { return racer.effect == score.effect; });
    if (ran || !leads(entered, score)) continue;
    auto result = announced(events, score.effect,
                            [&] { return add_effect(workspace, step.fitted, score, options.fit); });
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      tell(options.fit.decided, {Asked::refitted, score.effect, false, {}, result.error().reason});
      out.not_compared.push_back(score.effect);
      continue;
    }
    out.refits.push_back({score.effect, *std::move(result), 0.0});
    tell(options.fit.decided, {Asked::refitted,
                               score.effect,
                               true,
                               {},
                               "leads by evidence: fitted though its first step led nowhere"});
  }
  return {};
}

}  // namespace

Result<Contest> refit_leaders(Workspace& workspace, const Step& step,
                              const std::optional<Beaten>& beaten, const DiscoverOptions& options,
                              const DiscoverEvents& events) {
  Contest out;
  auto& refits = out.refits;
  Diagnosis entered = step.diagnosis;
  if (mesh_settles_it(step)) entered.effects.resize(1);
  auto raced = race(workspace, step.fitted, entered, options.fit, events.tried);
  if (!raced) return failure_of(raced);
  auto& racers = *raced;
  if (beaten && !mesh_settles_it(step) &&
      std::none_of(racers.begin(), racers.end(), [](const Racer& one) { return one.at_floor(); }))
    if (auto ran = let_beaten_run(workspace, *beaten, options, events, racers); !ran)
      return failure_of(ran);
  out.racers = racers;
  keep_leaders(racers, entered, step.diagnosis.floor.limits->search.leaders, options.fit.decided);
  const Workspace::Place here = workspace.place();
  for (size_t i = 0; i < racers.size(); ++i) {
    const Racer& racer = racers[i];
    if (of_no_use(racer, racers.front(), refits, step.diagnosis.floor)) {
      tell(options.fit.decided,
           {Asked::refitted,
            racer.effect,
            false,
            {racer.structured(), racer.limits().may_tie * racers.front().structured(),
             "search.may_tie"},
            refits.front().effect + " is at the noise floor, and this one is no equal"});
      continue;
    }
    FitOptions fit = options.fit;
    for (const Refit& rival : refits) {
      const double chi = rival.fitted.evaluation.chi(false);
      fit.aim_chi = fit.aim_chi == 0.0 ? chi : std::min(fit.aim_chi, chi);
    }
    workspace.start_from(here);
    refit_ahead(workspace, racers, i, refits, step.diagnosis.floor, fit);
    auto result = announced(events, racer.effect, [&] { return refit(workspace, racer, fit); });
    if (!result) {
      if (cancelled(result.error())) return failure_of(result);
      tell(options.fit.decided, {Asked::refitted, racer.effect, false, {}, result.error().reason});
      continue;  // a model without equilibrium explains nothing
    }
    refits.push_back({racer.effect, *std::move(result), 0.0});
    tell(options.fit.decided,
         {Asked::refitted,
          racer.effect,
          true,
          {refits.back().fitted.evaluation.chi(false),
           step.diagnosis.floor.limits->floor.at * step.diagnosis.floor.chi, "floor.at"},
          fmt::format("refitted in {} iterations: normalised residual {:.3f} on fitted {}, "
                      "{:.3f} without it; noise floor {:.3f}",
                      refits.back().fitted.iterations, refits.back().fitted.evaluation.chi(false),
                      seen_in_words(step.fitted.form.scene->capture),
                      step.fitted.evaluation.chi(false), step.diagnosis.floor.chi)});
    if (numerical(racer.effect) && mesh_kept_its_word(step, refits.back().fitted)) {
      rank(out, step);
      return out;
    }
  }
  if (auto tried = refit_unscreened(workspace, step, entered, options, events, out); !tried)
    return failure_of(tried);
  if (!refits.empty()) rank(out, step);
  return out;
}

void rank(Contest& contest, const Step& step) {
  auto& refits = contest.refits;
  const auto best = std::min_element(refits.begin(), refits.end(), [&](auto& a, auto& b) {
    return misfit(a.fitted) < misfit(b.fitted);
  });
  contest.reference = best->fitted;
  drop_pictures(contest.reference);
  contest.measured_noise2 = measured_noise2(step.fitted);
  for (const auto& refit : refits)
    contest.measured_noise2 = std::min(contest.measured_noise2, measured_noise2(refit.fitted));
  const Yardstick yardstick{&contest.reference, &step.diagnosis.floor, contest.measured_noise2};
  contest.before = refit_score(step.fitted, yardstick);
  for (auto& refit : refits) refit.score = refit_score(refit.fitted, yardstick);
  std::stable_sort(refits.begin(), refits.end(),
                   [](auto& a, auto& b) { return a.score > b.score; });
}

std::vector<Rival> rivals_of(const Contest& contest, double chosen) {
  std::vector<Rival> out;
  for (const Refit& one : contest.refits) {
    const Evaluation& left = one.fitted.evaluation;
    out.push_back({one.effect, one.score - chosen, left.chi(false), left.chi(true)});
  }
  return out;
}

double score_above(const Fitted& one, const Fitted& other, const Floor& floor) {
  const Yardstick yardstick{misfit(one) < misfit(other) ? &one : &other, &floor,
                            std::min(measured_noise2(one), measured_noise2(other))};
  return refit_score(one, yardstick) - refit_score(other, yardstick);
}

std::vector<std::string> narrow_losers(const Step& then, const Fitted& last) {
  const double won = std::pow(then.fitted.evaluation.chi(false), 2);
  const double taken = won - std::pow(last.evaluation.chi(false), 2);
  std::vector<std::string> losers;
  for (const Rival& rival : then.rivals)
    if (rival.effect != then.added && !numerical(rival.effect) &&
        std::pow(rival.chi_fit, 2) - won < taken)
      losers.push_back(rival.effect);
  return losers;
}

/// Of a misfit that effects had nothing to do with they explain 4 % in the median and 22 % in one
/// of four (linear steps of base models, bench/blind --small): what takes less than a tenth of the
/// fitted photos', of the held-out ones' and of the sensors' may be part of what has no name. Of
/// ten effects of one size the first takes as much. Near the floor it is no other: what renderer,
/// light and texture leave there is as large a share, and a field that bends to it takes some
/// percent.
Refusal why_refused(const Step& step, double before, const Refit& with) {
  using Why = Refusal::Why;
  const Floor& floor = step.diagnosis.floor;
  const double least = least_fall(step.diagnosis, with.effect);
  const bool moves_photos = !sensors_alone(*with.fitted.form.ingredients.back());
  const auto fell = [&](bool held_out) {
    return std::pow(step.fitted.evaluation.chi(held_out), 2) -
           std::pow(with.fitted.evaluation.chi(held_out), 2);
  };
  if (at_floor(step.fitted, floor) &&
      holds_null(with.fitted, with.fitted.form.ingredients.size() - 1))
    return {Why::may_be_nothing,
            with.effect,
            {std::max(step.fitted.evaluation.chi(false), step.fitted.evaluation.chi(true)),
             floor.limits->floor.at * floor.chi, "floor.at"}};
  const double pays = step.diagnosis.limits().nameable;
  if (with.score < before + pays)
    return {Why::does_not_pay, with.effect, {with.score - before, pays, "diagnosis.nameable"}};
  if (!held_out_allows(with.fitted, step.fitted, floor, least))
    return {Why::held_out_against, with.effect, {-fell(true), least, "diagnosis.tie"}};
  const double before_r2 = measured_r2(step.fitted.evaluation);
  const double after_r2 = measured_r2(with.fitted.evaluation);
  const bool speak = sensors_speak(before_r2 - after_r2, step.diagnosis);
  const bool seen = fell(false) >= least ||
                    (step.fitted.evaluation.chi(true) > floor.limits->floor.at * floor.chi &&
                     fell(true) >= least_fall(step.diagnosis, with.effect, true));
  if (!seen && moves_photos && !speak)
    return {Why::too_little, with.effect, {fell(false), least, "floor.err_share"}};
  const auto leaves = [&](bool held_out) {
    const double before = over_floor(step.fitted, floor, held_out);
    return before > 0.0 ? over_floor(with.fitted, floor, held_out) / before : 1.0;
  };
  const double left = std::min({leaves(false), leaves(true), speak ? after_r2 / before_r2 : 1.0});
  const double most = 1.0 - floor.limits->search.worth_a_name;
  const bool over =
      over_floor(step.fitted, floor, false) + over_floor(step.fitted, floor, true) > 0;
  if (moves_photos && !numerical(with.effect) && over && left > most)
    return {Why::more_is_there, with.effect, {left, most, "search.worth_a_name"}};
  return {Why::none, with.effect, {with.score - before, pays, "diagnosis.nameable"}};
}

std::string Refusal::words() const {
  switch (why) {
    case Why::none:
      return "";
    case Why::may_be_nothing:
      return effect +
             " was refitted, but its intervals hold its null, and without it the floor is "
             "reached";
    case Why::does_not_pay:
      return effect + " was refitted, but what it takes away does not pay for its parameters";
    case Why::held_out_against:
      return effect + " was refitted, but the held-out examples speak against it";
    case Why::too_little:
      return effect + " was refitted, but takes away less than renderers and meshes err by";
    case Why::more_is_there:
      return fmt::format(
          "{} was refitted, but leaves {:.0f} % of what is over the floor: what is there takes "
          "more",
          effect, 100.0 * by.value);
  }
  return "";
}

bool told_standing(const Decided& decided, const Refusal& refusal) {
  return tell(decided,
              {Asked::stands, refusal.effect, !refusal, refusal.by,
               refusal ? refusal.words() : "it says more than its parameters cost"},
              refusal.where);
}

Refusal refused_by(const Step& step, Refit with) {
  const Yardstick yardstick{&with.fitted, &step.diagnosis.floor, measured_noise2(with.fitted)};
  with.score = refit_score(with.fitted, yardstick);
  return why_refused(step, refit_score(step.fitted, yardstick), with);
}

}  // namespace hookeye
