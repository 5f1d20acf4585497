#include "estimation/discover.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "estimation/contest.h"
#include "estimation/swaps.h"

namespace hookeye {

namespace {

/// The photos are explained but for what a finer mesh would change. That is told beside the
/// parameters, whose intervals reach there (reach_for_mesh); a fit on that mesh would cost several
/// times all that was fitted before, and name nothing.
bool only_numerical_left(const Fitted& fitted, const Diagnosis& diagnosis) {
  return at_floor(fitted, diagnosis.floor) && measured_explained(fitted, diagnosis) &&
         std::all_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const auto& effect) {
           return numerical(effect.effect) || !nameable(effect, diagnosis);
         });
}

}  // namespace

std::vector<std::string> effects_in(const ModelForm& form) {
  std::vector<std::string> names;
  for (size_t i = base_form(form.scene).ingredients.size(); i < form.ingredients.size(); ++i)
    if (const std::string name = form.ingredients[i]->name();
        std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  return names;
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::explained:
      return "explained";
    case Verdict::ambiguous:
      return "ambiguous";
    default:
      return "unexplained";
  }
}

namespace {

/// ", and ... stands out by less than a finer mesh would change": the largest evidence that is kept
/// from being named by the mesh's error alone. "" where there is none.
std::string hidden_by_mesh(const Diagnosis& diagnosis) {
  if (diagnosis.mesh_fall < least_fall(diagnosis)) return "";
  for (const EffectScore& effect : diagnosis.effects)
    if (effect.testable && !numerical(effect.effect) &&
        effect.evidence >= std::max(kNameable, diagnosis.gate))
      return fmt::format(
          ", and {} stands out by less than a mesh finer still would change: give the body one "
          "(mesh: {{edge: ...}}) and run again",
          effect.effect);
  return "";
}

bool seen(const Fitted& fitted) {
  return std::any_of(fitted.evaluation.examples.begin(), fitted.evaluation.examples.end(),
                     [](const auto& example) { return !example.photos.empty(); });
}

}  // namespace

Verdict judge(const Fitted& fitted, const Diagnosis& diagnosis, const std::vector<std::string>& tie,
              std::string* why) {
  const double chi = fitted.evaluation.chi(false), held_out = fitted.evaluation.chi(true);
  const auto standing =
      only_numerical_left(fitted, diagnosis) ? std::vector<std::string>() : leaders(diagnosis);
  std::string sensors;
  const bool photos = at_floor(fitted, diagnosis.floor);
  const bool measured = measured_explained(fitted, diagnosis, &sensors);
  if (why) {
    *why = fmt::format("what is left is {:.2f} times the noise floor{}", chi / diagnosis.floor.chi,
                       held_out > 0.0
                           ? fmt::format(" ({:.2f} on held-out {})", held_out / diagnosis.floor.chi,
                                         seen(fitted) ? "photos" : "values")
                           : "");
    if (!sensors.empty()) *why += ", but " + sensors;
    if (!standing.empty())
      *why += fmt::format(", and {} still stand{} out", fmt::join(standing, " and "),
                          standing.size() == 1 ? "s" : "");
    else if (!photos)
      *why += hidden_by_mesh(diagnosis);
  }
  if (!tie.empty()) return Verdict::ambiguous;
  return photos && measured ? Verdict::explained : Verdict::unexplained;
}

namespace {

/// `why` is judge()'s, `refused` why the effect that came farthest was not added.
std::string say(const Discovery& discovery, std::string why, const std::string& refused) {
  const std::vector<std::string>& missing = discovery.missing;
  if (!refused.empty()) why += "; " + refused;
  if (missing.empty() && discovery.verdict == Verdict::explained)
    return fmt::format("{}: {}",
                       refused.empty() ? "nothing is missing"
                                       : "nothing that is missing "
                                         "pays for itself",
                       why);
  if (!discovery.tie.empty())
    return fmt::format("{}; these could not be told apart: {}", why,
                       fmt::join(discovery.tie, ", "));
  if (missing.empty())
    return fmt::format("{}: {}",
                       refused.empty() ? "not in the catalogue"
                                       : "nothing that was tried "
                                         "explains it",
                       why);
  return fmt::format("missing: {}; with {}, {}", fmt::join(missing, " and "),
                     missing.size() == 1 ? "it" : "them", why);
}

/// Why a refit does not stand beside the step that it started from; "" where it does.
std::string why_refused(const Step& step, double before, const Refit& with) {
  const double least = least_fall(step.diagnosis);
  const auto fell = [&](bool held_out) {
    return std::pow(step.fitted.evaluation.chi(held_out), 2) -
           std::pow(with.fitted.evaluation.chi(held_out), 2);
  };
  if (with.score < before + kNameable)
    return with.effect + " was refitted, but what it takes away does not pay for its parameters";
  if (!held_out_allows(with.fitted, step.fitted, step.diagnosis.floor, least))
    return with.effect + " was refitted, but the held-out examples speak against it";
  if (fell(false) < least && !sensors_alone(*with.fitted.form.ingredients.back()))
    return with.effect + " was refitted, but takes away less than renderers and meshes err by";
  return "";
}

/// The step in which one effect took another's place.
Step swapped_step(Swap swap) {
  Step step;
  step.name = step.added = std::move(swap.in.effect);
  step.dropped = {std::move(swap.out)};
  step.fitted = std::move(swap.in.fitted);
  return step;
}

/// A tie holds while its winner stands alone: where the winner was dropped later, or a rival was
/// found beside it, the later steps have decided.
void settle_tie(std::vector<std::string>& tie, const std::vector<std::string>& missing) {
  const auto has = [&](const std::string& name) {
    return std::find(missing.begin(), missing.end(), name) != missing.end();
  };
  if (!tie.empty() && (!has(tie.front()) || std::any_of(tie.begin() + 1, tie.end(), has)))
    tie.clear();
}

/// Of those that lost the contest of `then` by less of chi^2 than what later steps took away, the
/// nearest; null where there is none.
const Rival* narrow_loser(const Step& then, const Fitted& last) {
  const double won = std::pow(then.fitted.evaluation.chi(false), 2);
  const Rival* nearest = nullptr;
  double least = won - std::pow(last.evaluation.chi(false), 2);
  for (const Rival& rival : then.rivals) {
    const double lag = std::pow(rival.chi_fit, 2) - won;
    if (rival.effect == then.added || numerical(rival.effect) || lag >= least) continue;
    nearest = &rival, least = lag;
  }
  return nearest;
}

/// The loop: one step after the other, until nothing is left to add or to swap.
class Search {
 public:
  Search(Workspace& workspace, const DiscoverOptions& options, const DiscoverEvents& events)
      : workspace_(workspace),
        options_(options),
        events_(events),
        base_(base_form(workspace.scene().shared_from_this()).ingredients.size()) {}

  std::variant<Discovery, NumericalFailure> run(Step first) {
    out_.tie = options_.tie;
    const auto start = std::ssize(first.fitted.form.ingredients);
    out_.steps.push_back(std::move(first));
    // Swaps add nothing, and each betters the score; were they to go in circles, this ends it.
    const size_t most_steps = 1 + 3 * static_cast<size_t>(std::max(options_.max_effects, 0));
    while (true) {
      if (auto failure = diagnose_newest()) return *failure;
      if (together_) {
        out_.steps.push_back(*std::exchange(together_, std::nullopt));
        continue;
      }
      if (out_.steps.size() >= most_steps) break;
      const auto added = std::ssize(newest().fitted.form.ingredients) - start;
      auto went_on = next_step(options_.max_effects - static_cast<int>(added));
      if (auto* failure = std::get_if<NumericalFailure>(&went_on)) return *failure;
      if (!std::get<bool>(went_on) && !dropped_unsupported() && !reopened()) break;
    }
    return finish();
  }

 private:
  /// Whether there is a step more.
  using WentOn = std::variant<bool, NumericalFailure>;

  Step& newest() { return out_.steps.back(); }

  std::optional<NumericalFailure> diagnose_newest() {
    Step& step = newest();
    auto diagnosis = diagnose(workspace_, step.fitted, options_.diagnosis);
    if (auto* failure = std::get_if<NumericalFailure>(&diagnosis)) return *failure;
    step.diagnosis = std::get<Diagnosis>(std::move(diagnosis));
    reach_for_mesh(step.fitted, step.diagnosis);
    out_.floor = step.diagnosis.floor;
    if (events_.step) events_.step(step);
    return {};
  }

  /// `room`: for how many effects more.
  WentOn next_step(int room) {
    Step& step = newest();
    if (room <= 0 || only_numerical_left(step.fitted, step.diagnosis)) return false;
    if (auto better =
            swap_for_better(workspace_, step.fitted, out_.floor, base_, options_, events_)) {
      out_.steps.push_back(swapped_step(std::move(*better)));
      return true;
    }
    auto refitted = refit_leaders(workspace_, step, options_, events_);
    if (auto* failure = std::get_if<NumericalFailure>(&refitted)) return *failure;
    Contest& contest = std::get<Contest>(refitted);
    if (contest.refits.empty()) return false;
    if (auto found =
            swap_behind_refit(workspace_, contest.refits, out_.floor, base_, options_, events_)) {
      add_two(*found->first, std::move(contest.raced), swapped_step(std::move(found->second)));
      return true;
    }
    refused_ = why_refused(step, contest.before, contest.refits.front());
    if (!refused_.empty()) return add_pair(contest, room);
    add_winner(contest);
    return true;
  }

  void add_two(const Refit& first, std::vector<Raced> raced, Step second) {
    Step leading;
    leading.name = leading.added = first.effect;
    leading.raced = std::move(raced);
    leading.fitted = first.fitted;
    together_ = std::move(second);
    out_.steps.push_back(std::move(leading));
  }

  /// Where the best alone does not stand.
  WentOn add_pair(Contest& contest, int room) {
    const Step& step = newest();
    if (room < 2) return false;
    if (at_floor(step.fitted, step.diagnosis.floor) &&
        measured_explained(step.fitted, step.diagnosis))
      return false;
    auto tried = refit_pairs(workspace_, step, contest, options_, events_);
    if (auto* failure = std::get_if<NumericalFailure>(&tried)) return *failure;
    auto& pair = std::get<std::optional<Pair>>(tried);
    if (!pair || !why_refused(step, contest.before, pair->second).empty()) return false;
    refused_.clear();
    Step second;
    second.name = second.added = pair->second.effect;
    second.fitted = std::move(pair->second.fitted);
    add_two(pair->first, std::move(contest.raced), std::move(second));
    return true;
  }

  void add_winner(Contest& contest) {
    Refit& winner = contest.refits.front();
    Step next;
    next.name = next.added = winner.effect;
    next.raced = std::move(contest.raced);
    std::vector<const Refit*> equals;
    for (const auto& rival : contest.refits) {
      const Evaluation& left = rival.fitted.evaluation;
      next.rivals.push_back(
          {rival.effect, rival.score - winner.score, left.chi(false), left.chi(true)});
      if (&rival != &winner && rival.score > winner.score - kTie) equals.push_back(&rival);
    }
    next.fitted = std::move(winner.fitted);
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
      if (auto asked = ask_tie_again(workspace_, next.fitted, out_.tie, out_.floor, base_, options_,
                                     events_)) {
        out_.tie = std::move(asked->tie);
        if (asked->better) together_ = swapped_step(std::move(*asked->better));
      }
    }
    if (!equals.empty() && out_.tie.empty()) out_.tie.push_back(next.added);
    for (const Refit* rival : equals) out_.tie.push_back(rival->effect);
    out_.steps.push_back(std::move(next));
  }

  /// An effect that the last model can do without leaves it; what was added last of the others
  /// stands anew.
  bool dropped_unsupported() {
    auto lighter = drop_unsupported(workspace_, newest().fitted, out_.floor, base_, options_);
    if (!lighter || !unsupported_.insert(lighter->effect).second) return false;
    Step next;
    next.name = next.added = lighter->fitted.form.ingredients.back()->name();
    next.dropped = {next.added, lighter->effect};
    next.fitted = std::move(lighter->fitted);
    out_.steps.push_back(std::move(next));
    return true;
  }

  /// Contests that were won by less than what was missing then are held again: a coarse mesh may
  /// have let swelling pass for a suction. The nearest loser takes the winner's place in the last
  /// model.
  bool reopened() {
    const Fitted& last = newest().fitted;
    const auto standing = effects_in(last.form);
    const auto stands = [&](const std::string& effect) {
      return std::find(standing.begin(), standing.end(), effect) != standing.end();
    };
    for (size_t k = 0; k + 1 < out_.steps.size(); ++k) {
      const Step& then = out_.steps[k];
      if (numerical(then.added) || !stands(then.added)) continue;
      const Rival* rival = narrow_loser(then, last);
      if (!rival || stands(rival->effect) || !asked_.insert({then.added, rival->effect}).second)
        continue;
      auto asked = ask_tie_again(workspace_, last, {then.added, rival->effect}, out_.floor, base_,
                                 options_, events_);
      if (!asked) continue;
      if (asked->better) {
        out_.steps.push_back(swapped_step(std::move(*asked->better)));
        settle_tie(out_.tie, effects_in(newest().fitted.form));
        return true;
      }
      if (out_.tie.empty()) out_.tie = std::move(asked->tie);
    }
    return false;
  }

  Discovery finish() {
    std::string why;
    const Step& last = newest();
    out_.missing = effects_in(last.fitted.form);
    settle_tie(out_.tie, out_.missing);
    out_.verdict = judge(last.fitted, last.diagnosis, out_.tie, &why);
    out_.sentence = say(out_, why, refused_);
    return std::move(out_);
  }

  Workspace& workspace_;
  const DiscoverOptions& options_;
  const DiscoverEvents& events_;
  const size_t base_;  ///< ingredients of the capture's own model
  Discovery out_;
  std::string refused_;                ///< why the best of the last contest was not added
  std::optional<Step> together_;       ///< second of a pair, once the first is written
  std::set<std::string> unsupported_;  ///< were dropped once; who comes back stays
  std::set<std::pair<std::string, std::string>> asked_;  ///< winner and loser of reopened contests
};

}  // namespace

std::variant<Discovery, NumericalFailure> discover_from(Workspace& workspace, Step first,
                                                        const DiscoverOptions& options,
                                                        const DiscoverEvents& events) {
  return Search(workspace, options, events).run(std::move(first));
}

std::variant<Discovery, NumericalFailure> discover(Workspace& workspace, const ModelForm& form,
                                                   const VectorXd& start,
                                                   const DiscoverOptions& options,
                                                   const DiscoverEvents& events) {
  auto base = fit(workspace, form, start, options.fit);
  if (auto* failure = std::get_if<NumericalFailure>(&base)) return *failure;
  Step step;
  step.name = "base";
  step.fitted = std::get<Fitted>(std::move(base));
  return discover_from(workspace, std::move(step), options, events);
}

}  // namespace hookeye
