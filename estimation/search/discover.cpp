#include "estimation/search/discover.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/own_archive.h"
#include "estimation/search/conclusion.h"
#include "estimation/search/contest.h"
#include "estimation/search/fit_to_all.h"
#include "estimation/search/last_questions.h"
#include "estimation/search/measured_explained.h"
#include "estimation/search/mesh_first.h"
#include "estimation/search/pairs.h"
#include "estimation/search/shadow.h"
#include "estimation/search/swaps.h"
#include "estimation/search/widening.h"

namespace hookeye {

namespace {

/// All that a search fits may be given up but for its base.
DiscoverOptions of_rivals(DiscoverOptions options) {
  options.fit.most_iterations = kRivalIterations;
  return options;
}

/// The loop: one step after the other, until nothing is left to add or to swap.
class Search {
 public:
  Search(Workspace& workspace, const DiscoverOptions& options, const DiscoverEvents& events)
      : workspace_(workspace),
        options_(of_rivals(options)),
        shadow_(workspace, options_.fit),
        events_(watched(events)),
        base_(base_form(workspace.scene().shared_from_this()).ingredients.size()),
        wider_(workspace, options_.fit, events_) {}

  Result<Discovery> run(Step first) {
    out_.tie = options_.tie;
    const auto start = std::ssize(first.fitted.form.ingredients);
    out_.steps.push_back(std::move(first));
    // Swaps add nothing, and each betters the score; were they to go in circles, this ends it.
    const size_t most_steps =
        1 + static_cast<size_t>(limits().steps_an_effect * std::max(most_effects(), 0));
    while (true) {
      if (auto done = diagnose_newest(); !done) return failure_of(done);
      if (together_) {
        stand_in(*std::exchange(together_, std::nullopt));
        continue;
      }
      auto to_all = fit_to_all(workspace_, newest().fitted, newest().diagnosis, options_.fit);
      if (!to_all) return failure_of(to_all);
      out_.all = *std::move(to_all);
      if (out_.steps.size() >= most_steps) break;
      const auto added = std::ssize(newest().fitted.form.ingredients) - start;
      const int room = most_effects() - static_cast<int>(added);
      auto went_on = next_step(room);
      if (!went_on) return failure_of(went_on);
      if (*went_on) continue;
      auto asked = asked_last(room);
      if (!asked) return failure_of(asked);
      if (!*asked) break;
    }
    // Questions that were stopped have no answer: neither has the run.
    if (!cancelled()) ask_all_again();
    if (cancelled()) return stopped();
    return finish();
  }

 private:
  /// Every refit is scored beside, too.
  DiscoverEvents watched(DiscoverEvents events) {
    events.refitted = [this, told = events.refitted](const std::string& effect,
                                                     const Result<Fitted>& result) {
      if (told) told(effect, result);
      if (result && options_.scored) shadow_.refitted(*result);
    };
    return events;
  }

  /// Whether there is a step more.
  using WentOn = Result<bool>;

  Step& newest() { return out_.steps.back(); }
  int most_effects() const { return options_.max_effects.value_or(limits().max_effects); }
  const SearchLimits& limits() const { return workspace_.scene().limits->search; }
  const FitToAll* all() const { return out_.all ? &*out_.all : nullptr; }
  bool cancelled() const { return options_.fit.cancel && *options_.fit.cancel; }

  /// A step with other effects than the last contest chose: who lost it has lost to another model.
  void stand_in(Step step) {
    losers_.clear();
    last_contest_.forget();
    out_.steps.push_back(std::move(step));
  }

  Result<void> diagnose_newest() {
    shadow_.tell_all(options_.fit.decided);
    Step& step = newest();
    auto diagnosis = diagnose(workspace_, step.fitted, options_.diagnosis);
    if (!diagnosis) return failure_of(diagnosis);
    step.diagnosis = *std::move(diagnosis);
    reach_for_mesh(step.fitted, step.diagnosis);
    out_.floor = step.diagnosis.floor;
    // Whoever writes the step down evaluates it, and what is asked next begins here all the same.
    const Workspace::Place here = workspace_.place();
    if (events_.step) events_.step(step);
    for (const Decision& one : naming_decisions(step.diagnosis)) tell(options_.fit.decided, one);
    drop_pictures(step.fitted);
    if (options_.scored) shadow_.follow(step);
    workspace_.start_from(here);
    return {};
  }

  /// `room`: for how many effects more.
  WentOn next_step(int room) {
    mesh_refitted_ = false;
    refused_ = {};
    auto widened = widened_form(false);
    if (!widened) return failure_of(widened);
    if (*widened) return true;
    Step& step = newest();
    if (room <= 0 || only_numerical_left(step.fitted, step.diagnosis, all())) return false;
    if (auto better = swap_for_better(workspace_, step.fitted, out_.floor, base_, refused_swaps_,
                                      options_, events_)) {
      stand_in(swapped_step(std::move(*better)));
      return true;
    }
    auto refitted =
        refit_leaders(workspace_, step, last_contest_.beaten(out_.steps), options_, events_);
    if (!refitted) return failure_of(refitted);
    Contest& contest = *refitted;
    mesh_refitted_ = std::any_of(contest.refits.begin(), contest.refits.end(),
                                 [](const Refit& refit) { return numerical(refit.effect); });
    if (contest.refits.empty()) return false;
    if (mesh_refitted_ && !numerical(contest.refits.front().effect)) {
      auto wide = widened_form(true);  // the mesh has been asked, and is not what is missing
      if (!wide || *wide) return wide;
    }
    if (auto done = wider_.mend(contest, step, out_.floor); !done) return failure_of(done);
    if (auto done = wider_.ask_leaders(contest, step, out_.floor); !done) return failure_of(done);
    if (auto found = swap_behind_refit(workspace_, contest.refits, out_.floor, base_,
                                       refused_swaps_, options_, events_);
        found && told_standing(options_.fit.decided, refused_by(step, found->second.in))) {
      add_two(*found->first, contest, swapped_step(std::move(found->second)));
      return true;
    }
    tell_ranks(contest);
    refused_ = why_refused(step, contest.before, contest.refits.front());
    if (!told_standing(options_.fit.decided, refused_)) return add_pair(contest, room);
    auto wider = wider_.instead_of(contest.refits.front(), step.fitted, out_.floor);
    if (!wider) return failure_of(wider);
    if (auto& wide = *wider) {
      stand_in(wider_step(step.fitted, std::move(*wide)));
      return true;
    }
    add_winner(contest);
    return true;
  }

  /// Before another effect is asked for those that stand are asked for a wider form, the newest
  /// first; a mesh that stands out and may be all that is missing is settled before them, or has
  /// been asked. (A form has to take half of what is left, too.)
  WentOn widened_form(bool mesh_was_asked) {
    const Step& step = newest();
    const auto& all = step.fitted.form.ingredients;
    // Near the floor, too, a second name is one too many where the first one's form was too narrow.
    bool another = false;
    for (const EffectScore& score : step.diagnosis.effects) {
      if (!nameable(score, step.diagnosis)) continue;
      if (!mesh_was_asked && may_be_all(score.effect, step.diagnosis)) return false;
      another = another || !numerical(score.effect);
    }
    for (size_t at = all.size(); at-- > base_;) {
      const std::string name = all[at]->name();
      if (numerical(name) ||
          (on_floor(step.fitted, out_.floor) && !another && !wider_.came_to(*all[at])))
        continue;
      auto result = wider_.ask(step.fitted, at, out_.floor, another);
      if (!result) return failure_of(result);
      auto& wide = *result;
      if (!wide) continue;
      out_.steps.push_back(step_with(name, std::move(*wide), {name}));
      return true;
    }
    return false;
  }

  /// `now` with one of its effects in another form.
  static Step wider_step(const Fitted& now, Fitted wide) {
    size_t at = 0;
    while (key_of(*now.form.ingredients[at]) == key_of(*wide.form.ingredients[at])) ++at;
    const std::string name = wide.form.ingredients[at]->name();
    return step_with(name, std::move(wide), {name});
  }

  void tell_ranks(const Contest& contest) const {
    const double best = contest.refits.front().score;
    for (const Refit& one : contest.refits) {
      Decision decision{Asked::ranked,
                        one.effect,
                        &one == &contest.refits.front(),
                        {one.score - best, 0.0, ""},
                        "penalised log likelihood over that of the best refit"};
      if (const auto below = shadow_.below_best(one.fitted)) decision.parts["below_best"] = *below;
      tell(options_.fit.decided, std::move(decision));
    }
  }

  void add_two(const Refit& first, Contest& contest, Step second) {
    Step leading;
    leading.name = leading.added = first.effect;
    leading.rivals = rivals_of(contest, first.score);
    leading.raced = raced(contest.racers);
    leading.not_compared = contest.not_compared;
    leading.fitted = first.fitted;
    together_ = std::move(second);
    stand_in(std::move(leading));
  }

  /// Where the best alone does not stand.
  WentOn add_pair(Contest& contest, int room) {
    const Step& step = newest();
    if (room < 2) return false;
    auto beside = refit_beside_best(workspace_, step, contest, options_, events_);
    if (!beside) return failure_of(beside);
    auto& pair = *beside;
    if (!pair) {
      if (explained(step.fitted, step.diagnosis)) return false;
      auto tried = refit_pairs(workspace_, step, contest, options_, events_);
      if (!tried) return failure_of(tried);
      pair = *std::move(tried);
      if (!pair ||
          !told_standing(options_.fit.decided, why_refused(step, contest.before, pair->second)))
        return false;
    }
    refused_ = {};
    add_two(pair->first, contest,
            step_with(std::move(pair->second.effect), std::move(pair->second.fitted)));
    return true;
  }

  void add_winner(Contest& contest) {
    Refit& winner = contest.refits.front();
    Step next;
    next.name = next.added = winner.effect;
    next.raced = raced(contest.racers);
    next.rivals = rivals_of(contest, winner.score);
    next.not_compared = contest.not_compared;
    const double tie = newest().diagnosis.limits().tie;
    std::vector<const Refit*> equals;
    for (const auto& rival : contest.refits)
      if (&rival != &winner && tell(options_.fit.decided,
                                    {Asked::tied,
                                     rival.effect,
                                     rival.score > winner.score - tie,
                                     {rival.score - winner.score, -tie, "diagnosis.tie"},
                                     "its penalised log likelihood over that of " + winner.effect}))
        equals.push_back(&rival);
    next.fitted = std::move(winner.fitted);
    losers_.clear();
    if (spoils_held_out(next.fitted, out_.floor))
      losers_.assign(contest.refits.begin() + 1, contest.refits.end());
    for (Refit& loser : losers_) drop_pictures(loser.fitted);
    if (next.fitted.form.ingredients.size() > base_ + 1)
      if (auto lighter = backward(workspace_, next.fitted, out_.floor, base_, options_)) {
        next.dropped = {lighter->effect}, next.fitted = std::move(lighter->fitted);
        std::erase_if(equals, [&](const Refit* rival) {
          return !equals_after_swap(workspace_, rival->fitted, next.fitted, lighter->effect,
                                    out_.floor, options_.fit);
        });
      }
    settle_tie(out_.tie, effects_in(next.fitted.form));
    if (out_.tie.size() > 1) {
      if (auto asked = ask_tie_again(workspace_, next.fitted, out_.tie, out_.floor, base_,
                                     refused_swaps_, options_, events_)) {
        out_.tie = std::move(asked->tie);
        if (asked->better) together_ = swapped_step(std::move(*asked->better));
      }
    }
    if (!equals.empty() && out_.tie.empty()) out_.tie.push_back(next.added);
    for (const Refit* rival : equals) out_.tie.push_back(rival->effect);
    last_contest_.won(next.added, out_.steps.size() - 1, std::move(contest.racers));
    out_.steps.push_back(std::move(next));
  }

  /// Puts the step, if there is one, behind the others.
  WentOn taken(LastAnswer answer) {
    if (!answer) return failure_of(answer);
    auto& step = *answer;
    if (step) out_.steps.push_back(std::move(*step));
    return step.has_value();
  }

  /// Where nothing can be added: last_questions.h.
  WentOn asked_last(int room) {
    const auto stays = [](const WentOn& result) { return result.has_value() && !*result; };
    if (room > 0 && !mesh_refitted_ && !out_.all)
      if (auto result = taken(settled_mesh(workspace_, newest(), options_, events_));
          !stays(result))
        return result;
    if (auto result = widened_form(true); !stays(result)) return result;
    auto lighter = without_idle(workspace_, newest().fitted, out_.floor, base_, options_, events_);
    if (lighter && idle_.insert(lighter->dropped.back()).second) {
      stand_in(std::move(*lighter));
      return true;
    }
    if (reopened()) return true;
    const std::vector<Refit> losers = std::exchange(losers_, {});
    if (out_.all) return false;
    return taken(wider_loser(workspace_, newest(), losers, options_, events_));
  }

  /// Whether another won a contest that was held again.
  bool reopened() {
    auto asked =
        contests_again(workspace_, out_.steps, base_, asked_, refused_swaps_, options_, events_);
    if (asked.better) {
      stand_in(swapped_step(std::move(*asked.better)));
      settle_tie(out_.tie, effects_in(newest().fitted.form));
      return true;
    }
    if (out_.tie.empty()) out_.tie = std::move(asked.tie);
    return false;
  }

  /// Where held-out photos were missed by values alone, they tell rivals apart by being fitted.
  void ask_all_again() {
    if (!out_.all) return;
    settle_tie(out_.tie, effects_in(newest().fitted.form));
    out_.tie = tie_of_all(workspace_, *out_.all, whole_run(), out_.tie, out_.floor, base_, options_,
                          events_);
  }

  std::vector<Contested> whole_run() const {
    std::vector<Contested> steps = options_.past;
    for (const Step& step : out_.steps) steps.push_back(contested(step));
    return steps;
  }

  Discovery finish() {
    shadow_.tell_all(options_.fit.decided);
    conclude(out_, whole_run(), refused_, options_.fit.decided);
    return std::move(out_);
  }

  Workspace& workspace_;
  const DiscoverOptions options_;
  Shadow shadow_;  ///< of all refits; decides nothing
  const DiscoverEvents events_;
  const size_t base_;  ///< ingredients of the capture's own model
  Discovery out_;
  Refusal refused_;             ///< why the best of the last contest was not added
  bool mesh_refitted_ = false;  ///< in the last contest
  RefusedSwaps refused_swaps_;
  WiderForms wider_;
  LastContest last_contest_;
  std::vector<Refit> losers_;     ///< of the last contest, where its winner spoilt held-out photos
  std::optional<Step> together_;  ///< second of a pair, once the first is written
  std::set<std::string> idle_;    ///< were dropped once; who comes back stays
  AskedAgain asked_;
};

}  // namespace

Result<Discovery> discover_from(Workspace& workspace, Step first, const DiscoverOptions& options,
                                const DiscoverEvents& events) {
  const OwnArchive archive(workspace);
  return Search(workspace, options, events).run(std::move(first));
}

Result<Discovery> discover(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                           const DiscoverOptions& options, const DiscoverEvents& events) {
  const OwnArchive archive(workspace);
  auto base = fit(workspace, form, start, options.fit);
  if (!base) return failure_of(base);
  Step step;
  step.name = "base";
  step.fitted = *std::move(base);
  return discover_from(workspace, std::move(step), options, events);
}

}  // namespace hookeye
