#include "estimation/discover.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
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

struct EffectiveMisfit {
  double r2 = 0.0, count = 0.0;
  EffectiveMisfit operator+(const EffectiveMisfit& other) const {
    return {r2 + other.r2, count + other.count};
  }
  /// Variance, `least` at least.
  double noise(double least) const { return count > 0.0 ? std::max(least, r2 / count) : least; }
  double log_likelihood(double least) const {
    return -0.5 * count * std::log(noise(least)) - 0.5 * r2 / noise(least);
  }
};

/// |z|^2 of the photos of `fitted` with the weights that the correlation in `reference` gives; of
/// all examples or of those held out.
EffectiveMisfit photo_misfit(const Fitted& fitted, const Fitted& reference, bool held_out_alone) {
  EffectiveMisfit out;
  for (size_t e = 0; e < fitted.evaluation.examples.size(); ++e) {
    const auto& example = fitted.evaluation.examples[e];
    if (held_out_alone && !example.held_out) continue;
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const FlowStatistics own = flow_statistics(example.photos[k].flow);
      const FlowStatistics weight =
          flow_statistics(reference.evaluation.examples[e].photos[k].flow);
      if (own.count == 0.0 || weight.count == 0.0) continue;
      const double w = weight.effective / weight.count;
      out.r2 += w * own.variance * weight.count;
      out.count += w * weight.count;
    }
  }
  return out;
}

/// The same of forces, moments and positions.
EffectiveMisfit measured_misfit(const Fitted& fitted, bool held_out_alone) {
  EffectiveMisfit out;
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& measured : example.measured)
      if (!held_out_alone || example.held_out)
        out = out + EffectiveMisfit{measured.r.squaredNorm(), 3.0};
  return out;
}

int parameters_of_sensors(const ModelForm& form) {
  int count = 0;
  for (const auto& ingredient : form.ingredients)
    if (sensors_alone(*ingredient)) count += static_cast<int>(ingredient->parameters().size());
  return count;
}

}  // namespace

double measured_noise2(const Fitted& fitted) { return measured_misfit(fitted, false).noise(1.0); }

double refit_score(const Fitted& fitted, const Yardstick& yardstick) {
  const EffectiveMisfit photos = photo_misfit(fitted, *yardstick.reference, false);
  const EffectiveMisfit measured = measured_misfit(fitted, false);
  const int of_sensors = parameters_of_sensors(fitted.form);
  const auto price = [](int parameters, double count) {
    return 0.5 * parameters * std::log(std::max(count, 2.0));
  };
  return photos.log_likelihood(yardstick.floor->cell_variance) -
         0.5 * measured.r2 / yardstick.measured_noise2 -
         price(fitted.form.size() - of_sensors, photos.count + measured.count) -
         price(of_sensors, measured.count);
}

bool held_out_allows(const Fitted& with, const Fitted& without, const Floor& floor, double least) {
  const auto r2 = [](const Fitted& fitted) { return std::pow(fitted.evaluation.chi(true), 2); };
  const EffectiveMisfit before = measured_misfit(without, true),
                        after = measured_misfit(with, true);
  double loss = 0.5 * (after.r2 - before.r2) / std::min(before.noise(1.0), after.noise(1.0));
  if (r2(with) > r2(without) + least)
    loss += photo_misfit(without, with, true).log_likelihood(floor.cell_variance) -
            photo_misfit(with, with, true).log_likelihood(floor.cell_variance);
  return loss < kTie;
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

}  // namespace

std::variant<Discovery, NumericalFailure> discover_from(Workspace& workspace, Step first,
                                                        const DiscoverOptions& options,
                                                        const DiscoverEvents& events) {
  Discovery out;
  out.tie = options.tie;
  const size_t base_ingredients =
      base_form(workspace.scene().shared_from_this()).ingredients.size();
  out.steps.push_back(std::move(first));
  std::string refused;           // why the best of the last contest was not added
  std::optional<Step> together;  // second of a pair, once the first is written
  for (int added = 0;; ++added) {
    Step& step = out.steps.back();
    auto diagnosis = diagnose(workspace, step.fitted, options.diagnosis);
    if (auto* failure = std::get_if<NumericalFailure>(&diagnosis)) return *failure;
    step.diagnosis = std::get<Diagnosis>(std::move(diagnosis));
    reach_for_mesh(step.fitted, step.diagnosis);
    out.floor = step.diagnosis.floor;
    if (events.step) events.step(step);
    if (together) {
      out.steps.push_back(*std::exchange(together, std::nullopt));
      continue;
    }
    if (added >= options.max_effects || only_numerical_left(step.fitted, step.diagnosis)) break;
    if (auto better =
            swap_for_better(workspace, step.fitted, out.floor, base_ingredients, options, events)) {
      out.steps.push_back(swapped_step(std::move(*better)));
      continue;
    }
    auto contest = refit_leaders(workspace, step, options, events);
    if (auto* failure = std::get_if<NumericalFailure>(&contest)) return *failure;
    auto& [raced, ranked, before, reference, noise2] = std::get<Contest>(contest);
    if (ranked.empty()) break;
    Refit& winner = ranked.front();
    if (auto found =
            swap_behind_refit(workspace, ranked, out.floor, base_ingredients, options, events)) {
      Step leading;
      leading.name = leading.added = found->first->effect;
      leading.raced = std::move(raced);
      leading.fitted = found->first->fitted;
      together = swapped_step(std::move(found->second));
      out.steps.push_back(std::move(leading));
      continue;
    }
    refused = why_refused(step, before, winner);
    if (!refused.empty()) {
      if (at_floor(step.fitted, step.diagnosis.floor) &&
          measured_explained(step.fitted, step.diagnosis))
        break;
      auto tried = refit_pairs(workspace, step, std::get<Contest>(contest), options, events);
      if (auto* failure = std::get_if<NumericalFailure>(&tried)) return *failure;
      auto& pair = std::get<std::optional<Pair>>(tried);
      if (!pair || added + 2 > options.max_effects ||
          !why_refused(step, before, pair->second).empty())
        break;
      refused.clear();
      Step leading;
      leading.name = leading.added = pair->first.effect;
      leading.raced = std::move(raced);
      leading.fitted = std::move(pair->first.fitted);
      together.emplace();
      together->name = together->added = pair->second.effect;
      together->fitted = std::move(pair->second.fitted);
      out.steps.push_back(std::move(leading));
      continue;
    }
    Step next;
    next.name = next.added = winner.effect;
    next.raced = std::move(raced);
    std::vector<const Refit*> equals;
    for (const auto& rival : ranked) {
      const Evaluation& left = rival.fitted.evaluation;
      next.rivals.push_back(
          {rival.effect, rival.score - winner.score, left.chi(false), left.chi(true)});
      if (&rival != &winner && rival.score > winner.score - kTie) equals.push_back(&rival);
    }
    next.fitted = std::move(winner.fitted);
    if (next.fitted.form.ingredients.size() > base_ingredients + 1)
      if (auto lighter = backward(workspace, next.fitted, out.floor, base_ingredients, options)) {
        next.dropped = {lighter->effect}, next.fitted = std::move(lighter->fitted);
        std::erase_if(equals, [&](const Refit* rival) {
          return !equals_after_swap(workspace, rival->fitted, next.fitted, lighter->effect,
                                    out.floor, options.fit);
        });
      }
    settle_tie(out.tie, effects_in(next.fitted.form));
    if (out.tie.size() > 1) {
      auto asked = ask_tie_again(workspace, next.fitted, out.tie, out.floor, base_ingredients,
                                 options, events);
      out.tie = std::move(asked.tie);
      if (asked.better) together = swapped_step(std::move(*asked.better));
    }
    if (!equals.empty() && out.tie.empty()) out.tie.push_back(next.added);
    for (const Refit* rival : equals) out.tie.push_back(rival->effect);
    out.steps.push_back(std::move(next));
  }
  std::string why;
  const Step& last = out.steps.back();
  out.missing = effects_in(last.fitted.form);
  settle_tie(out.tie, out.missing);
  out.verdict = judge(last.fitted, last.diagnosis, out.tie, &why);
  out.sentence = say(out, why, refused);
  return out;
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
