#include "estimation/discover.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hookeye {

namespace {

/// What texture and shading errors of another renderer leave over the floor of the rest photos.
constexpr double kAtFloor = 1.3;

}  // namespace

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

std::variant<Fitted, NumericalFailure> add_effect(Workspace& workspace, const Fitted& current,
                                                  const EffectScore& score,
                                                  const FitOptions& options) {
  const Effect* effect = find_effect(score.effect);
  const Model model = current.form.realise(current.p);
  VectorXd values = score.values;
  auto ingredient = effect->refit_form(model, score.best, values);
  const auto parameters = ingredient->parameters();
  if (effect->remeshes(ingredient->variant())) {
    auto [form, p] = transfer(model, effect->refit_scene(*model.scene, ingredient->variant()));
    form.ingredients.push_back(std::move(ingredient));
    FitOptions warm = options;
    warm.coarse_to_fine = false;
    return fit(workspace, form, p, warm);
  }
  ModelForm form = current.form;
  form.ingredients.push_back(ingredient);
  VectorXd start(current.p.size() + values.size());
  // The linear step is a direction more than a length: where even half of it has no equilibrium or
  // is worse than the null, the fit starts from the null.
  FitOptions warm = options;
  warm.coarse_to_fine = false;
  std::variant<Fitted, NumericalFailure> result = NumericalFailure{"", 0.0, "not started"};
  for (double share : {1.0, 0.3, 0.0}) {
    if (options.cancel && options.cancel->load()) return NumericalFailure{"", 0.0, "cancelled"};
    start.head(current.p.size()) = current.p;
    for (int i = 0; i < values.size(); ++i) {
      // the refit form may have other parameters than the scored one: then its own start counts
      const double from =
          parameters.size() == static_cast<size_t>(score.values.size()) && ingredient == score.best
              ? parameters[i].value
              : values[i];
      const double v = from + share * (values[i] - from);
      start[current.p.size() + i] = std::clamp(v, parameters[i].low, parameters[i].high);
    }
    result = fit(workspace, form, start, warm);
    if (std::holds_alternative<Fitted>(result)) return result;
    if (std::get<NumericalFailure>(result).reason == "cancelled") return result;
  }
  return result;
}

namespace {

struct EffectiveMisfit {
  double r2 = 0.0, count = 0.0;
};

/// |z|^2 of `fitted` with the weights that the correlation in `reference` gives.
EffectiveMisfit effective_misfit(const Fitted& fitted, const Fitted& reference) {
  EffectiveMisfit out;
  for (size_t e = 0; e < fitted.evaluation.examples.size(); ++e) {
    const auto& example = fitted.evaluation.examples[e];
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const FlowStatistics own = flow_statistics(example.photos[k].flow);
      const FlowStatistics weight =
          flow_statistics(reference.evaluation.examples[e].photos[k].flow);
      if (own.count == 0.0 || weight.count == 0.0) continue;
      const double w = weight.effective / weight.count;
      out.r2 += w * own.variance * weight.count;
      out.count += w * weight.count;
    }
    for (const auto& measured : example.measured) {
      out.r2 += measured.r.squaredNorm();
      out.count += 3.0;
    }
  }
  return out;
}

}  // namespace

double refit_score(const Fitted& fitted, const Fitted& reference, const Floor& floor) {
  const EffectiveMisfit misfit = effective_misfit(fitted, reference);
  const double noise = std::max(floor.cell_variance, misfit.r2 / misfit.count);
  return -0.5 * misfit.count * std::log(noise) - 0.5 * misfit.r2 / noise -
         0.5 * fitted.form.size() * std::log(std::max(misfit.count, 2.0));
}

Verdict judge(const Fitted& fitted, const Diagnosis& diagnosis, const std::vector<std::string>& tie,
              std::string* why) {
  const double chi = fitted.evaluation.chi(false);
  bool something = false;
  for (const auto& effect : diagnosis.effects) something |= nameable(effect, diagnosis);
  const bool at_floor = chi <= kAtFloor * diagnosis.floor.chi;
  if (why)
    *why = fmt::format("what is left is {:.2f} times the noise floor{}", chi / diagnosis.floor.chi,
                       something ? ", and an effect of the catalogue still stands out" : "");
  if (!tie.empty()) return Verdict::ambiguous;
  return at_floor ? Verdict::explained : Verdict::unexplained;
}

namespace {

EffectGroup group_of(const EffectScore& score) { return find_effect(score.effect)->group(); }

/// Effects worth a refit, best first. A material is not named before the mesh is settled: a
/// numerical effect that could be named is refitted beside it, whatever its rank.
std::vector<const EffectScore*> leaders(const Diagnosis& diagnosis, int most) {
  std::vector<const EffectScore*> out;
  bool material = false;
  for (const auto& effect : diagnosis.effects) {
    if (!nameable(effect, diagnosis)) continue;
    const bool numerical = group_of(effect) == EffectGroup::numerical;
    if (static_cast<int>(out.size()) >= most && !(material && numerical)) continue;
    material |= group_of(effect) == EffectGroup::material;
    out.push_back(&effect);
  }
  return out;
}

struct Refit {
  std::string effect;
  Fitted fitted;
  double score = 0.0;
};

bool cancelled(const NumericalFailure& failure) { return failure.reason == "cancelled"; }

/// Within 1.3 times the floor on the fitted photos and on the held-out ones.
bool at_floor(const Fitted& fitted, const Floor& floor) {
  return fitted.evaluation.chi(false) <= kAtFloor * floor.chi &&
         fitted.evaluation.chi(true) <= kAtFloor * floor.chi;
}

/// Refits the leaders and scores them on fitted and held-out photos with the correlation of the
/// best of them. Best first.
std::variant<std::vector<Refit>, NumericalFailure> refit_leaders(Workspace& workspace,
                                                                 const Step& step,
                                                                 const DiscoverOptions& options,
                                                                 const DiscoverEvents& events) {
  std::vector<Refit> refits;
  const auto worth = leaders(step.diagnosis, options.leaders);
  for (const EffectScore* leader : worth) {
    // Nothing can do better than the floor; once it is reached only a tie in evidence is of use.
    if (!refits.empty() && at_floor(refits.front().fitted, step.diagnosis.floor) &&
        leader->evidence < worth.front()->evidence - kTie &&
        group_of(*leader) != EffectGroup::numerical)
      continue;
    if (events.refitting) events.refitting(leader->effect);
    auto result = add_effect(workspace, step.fitted, *leader, options.fit);
    if (auto* failure = std::get_if<NumericalFailure>(&result)) {
      if (cancelled(*failure)) return *failure;
      continue;  // a model without equilibrium explains nothing
    }
    if (events.refitted) events.refitted(leader->effect, std::get<Fitted>(result));
    refits.push_back({leader->effect, std::get<Fitted>(std::move(result)), 0.0});
  }
  if (refits.empty()) return refits;
  auto total_chi = [](const Fitted& f) { return f.evaluation.chi(false) + f.evaluation.chi(true); };
  const auto best = std::min_element(refits.begin(), refits.end(), [&](auto& a, auto& b) {
    return total_chi(a.fitted) < total_chi(b.fitted);
  });
  const Fitted reference = best->fitted;
  for (auto& refit : refits)
    refit.score = refit_score(refit.fitted, reference, step.diagnosis.floor);
  std::stable_sort(refits.begin(), refits.end(),
                   [](auto& a, auto& b) { return a.score > b.score; });
  return refits;
}

/// Drops an earlier effect that a later one made idle: one backward swap.
std::optional<Refit> backward(Workspace& workspace, const Fitted& current, const Floor& floor,
                              size_t first_effect, const DiscoverOptions& options) {
  const double full = refit_score(current, current, floor);
  int offset = 0;
  for (size_t i = 0; i + 1 < current.form.ingredients.size(); ++i) {
    const int n = static_cast<int>(current.form.ingredients[i]->parameters().size());
    const Effect* effect = find_effect(current.form.ingredients[i]->name());
    const bool mesh = effect && effect->remeshes(current.form.ingredients[i]->variant());
    if (i >= first_effect && !mesh) {
      ModelForm form = current.form;
      form.ingredients.erase(form.ingredients.begin() + i);
      VectorXd p(current.p.size() - n);
      p << current.p.head(offset), current.p.tail(current.p.size() - offset - n);
      FitOptions warm = options.fit;
      warm.coarse_to_fine = false;
      auto result = fit(workspace, form, p, warm);
      if (auto* fitted = std::get_if<Fitted>(&result)) {
        const double score = refit_score(*fitted, current, floor);
        if (score > full - kTie) return Refit{"", std::move(*fitted), score};
      }
    }
    offset += n;
  }
  return {};
}

std::string say(const Discovery& discovery, const std::string& why) {
  std::vector<std::string> added;
  for (const auto& step : discovery.steps)
    if (!step.added.empty()) added.push_back(step.added);
  if (added.empty() && discovery.verdict == Verdict::explained)
    return fmt::format("nothing is missing: {}", why);
  if (!discovery.tie.empty())
    return fmt::format("{}; these could not be told apart: {}", why,
                       fmt::join(discovery.tie, ", "));
  if (added.empty()) return fmt::format("not in the catalogue: {}", why);
  return fmt::format("missing: {}; with it, {}", fmt::join(added, " and "), why);
}

}  // namespace

std::variant<Discovery, NumericalFailure> discover_from(Workspace& workspace, Step first,
                                                        const DiscoverOptions& options,
                                                        const DiscoverEvents& events) {
  Discovery out;
  const size_t base_ingredients =
      base_form(workspace.scene().shared_from_this()).ingredients.size();
  out.steps.push_back(std::move(first));
  for (int added = 0;; ++added) {
    Step& step = out.steps.back();
    auto diagnosis = diagnose(workspace, step.fitted, options.diagnosis);
    if (auto* failure = std::get_if<NumericalFailure>(&diagnosis)) return *failure;
    step.diagnosis = std::get<Diagnosis>(std::move(diagnosis));
    out.floor = step.diagnosis.floor;
    if (events.step) events.step(step);
    if (added >= options.max_effects) break;
    auto refits = refit_leaders(workspace, step, options, events);
    if (auto* failure = std::get_if<NumericalFailure>(&refits)) return *failure;
    auto& ranked = std::get<std::vector<Refit>>(refits);
    if (ranked.empty()) break;
    Refit& winner = ranked.front();
    const double before = refit_score(step.fitted, winner.fitted, step.diagnosis.floor);
    const bool held = step.fitted.evaluation.chi(true) > 0.0;
    const bool pays_held_out =
        !held || winner.fitted.evaluation.chi(true) < step.fitted.evaluation.chi(true);
    const double fell = std::pow(step.fitted.evaluation.chi(false), 2) -
                        std::pow(winner.fitted.evaluation.chi(false), 2);
    if (winner.score < before + kNameable || !pays_held_out ||
        fell < least_fall(step.diagnosis.floor))
      break;
    Step next;
    next.name = next.added = winner.effect;
    for (const auto& rival : ranked) {
      next.rivals.push_back({rival.effect, rival.score - winner.score});
      if (&rival != &winner && rival.score > winner.score - kTie) {
        if (out.tie.empty()) out.tie.push_back(winner.effect);
        out.tie.push_back(rival.effect);
      }
    }
    next.fitted = std::move(winner.fitted);
    if (next.fitted.form.ingredients.size() > base_ingredients + 1)
      if (auto lighter = backward(workspace, next.fitted, out.floor, base_ingredients, options))
        next.fitted = std::move(lighter->fitted);
    out.steps.push_back(std::move(next));
  }
  std::string why;
  const Step& last = out.steps.back();
  out.verdict = judge(last.fitted, last.diagnosis, out.tie, &why);
  out.sentence = say(out, why);
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
