#include "estimation/refit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/discover.h"
#include "estimation/kept_stiffness.h"

namespace hookeye {

namespace {

constexpr size_t kSecondRound = 4;

bool cancelled(const NumericalFailure& failure) { return failure.reason == "cancelled"; }

/// The effect that has its own mesh in this form. Null: the mesh stays.
const Effect* remeshed_by(const Ingredient& ingredient) {
  const Effect* effect = find_effect(ingredient.name());
  return effect && effect->remeshes(ingredient.variant()) ? effect : nullptr;
}

/// The model with one effect more on the present mesh, and where to start it.
struct Extension {
  ModelForm form;
  VectorXd start;

  /// `share` of the scored step, the fitted parameters moving with it: a modulus that has made up
  /// for a wall would, with the wall, hold the body back twice. The refit form may have other
  /// parameters than the scored one (log stiffness for compliance): it is told where the scored one
  /// would start.
  Extension(const Fitted& current, const EffectScore& score, double share) : form(current.form) {
    const auto scored = score.best->parameters();
    VectorXd nulls(score.values.size());
    for (int i = 0; i < nulls.size(); ++i) nulls[i] = scored[i].value;
    VectorXd values = nulls + share * (score.values - nulls);
    const Model model = realised(current);
    auto ingredient = find_effect(score.effect)->refit_form(model, score.best, values);
    if (remeshed_by(*ingredient)) {  // what the other mesh changes, linear, stands for it here
      ingredient = score.best;
      values = nulls + share * (score.values - nulls);
    }
    const auto parameters = ingredient->parameters();
    for (int i = 0; i < values.size(); ++i)
      values[i] = std::clamp(values[i], parameters[i].low, parameters[i].high);
    form.ingredients.push_back(std::move(ingredient));
    start.resize(current.p.size() + values.size());
    start << moved(current, share * score.base_step), values;
  }

 private:
  /// No further than one Gauss-Newton step of a trial goes (bounded_step).
  static VectorXd moved(const Fitted& current, const VectorXd& change) {
    if (change.size() != current.p.size()) return current.p;  // read from a run that did not say
    const Scaling scaling{current.form.parameters()};
    return bounded_step(scaling, current.p, change.cwiseQuotient(scaling.dp_dx(current.p)));
  }
};

/// A refit form without a way back to the null (a hard clamp) starts in the same place whatever the
/// share of the linear step.
bool starts_anywhere(const Fitted& current, const EffectScore& score) {
  return Extension(current, score, 1.0).start == Extension(current, score, 0.0).start;
}

/// The linear step is a direction more than a length: where it has no equilibrium or is worse than
/// the null, `run(extension)` starts nearer to the null.
template <class Run>
auto from_shares(const Fitted& current, const EffectScore& score, const FitOptions& options,
                 const Run& run) {
  auto result = run(Extension(current, score, 1.0));
  if (starts_anywhere(current, score)) return result;
  for (double share : {0.3, 0.1, 0.0}) {
    const auto* failure = std::get_if<NumericalFailure>(&result);
    if (!failure || cancelled(*failure) || (options.cancel && options.cancel->load())) break;
    result = run(Extension(current, score, share));
  }
  return result;
}

FitOptions warm(const FitOptions& options) {
  FitOptions out = options;
  out.coarse_to_fine = false;
  return out;
}

/// The refit form of `scored`, when it lives on a mesh of its own. Null: it does not.
std::shared_ptr<const Ingredient> remeshing_form(const Model& model,
                                                 const std::shared_ptr<const Ingredient>& scored,
                                                 VectorXd values) {
  auto form = find_effect(scored->name())->refit_form(model, scored, values);
  return remeshed_by(*form) ? form : nullptr;
}

/// Fits `model` on the mesh of `remeshing`, which is added to it.
std::variant<Fitted, NumericalFailure> fit_on_its_mesh(Workspace& workspace, const Model& model,
                                                       std::shared_ptr<const Ingredient> remeshing,
                                                       const FitOptions& options) {
  const Effect& effect = *remeshed_by(*remeshing);
  auto [form, start] = transfer(model, effect.refit_scene(*model.scene, remeshing->variant()));
  form.ingredients.push_back(std::move(remeshing));
  VectorXd all = form.initial();
  all.head(start.size()) = start;
  return fit(workspace, form, all, warm(options));
}

/// `fitted` with another form of its last effect, which `change` makes of the present one and the
/// model before it. Empty: it makes none.
std::optional<std::pair<ModelForm, VectorXd>> with_other_form(
    const Fitted& fitted,
    std::shared_ptr<const Ingredient> (Effect::*change)(const Model&, const Ingredient&,
                                                        VectorXd& values) const) {
  const Ingredient& last = *fitted.form.ingredients.back();
  const auto own = static_cast<Eigen::Index>(last.parameters().size());
  const VectorXd before = fitted.p.head(fitted.p.size() - own);
  ModelForm other = fitted.form;
  other.ingredients.pop_back();
  VectorXd values = fitted.p.tail(own);
  auto form = (find_effect(last.name())->*change)(other.realise(before), last, values);
  if (!form) return std::nullopt;
  const auto parameters = form->parameters();
  for (int i = 0; i < values.size(); ++i)
    values[i] = std::clamp(values[i], parameters[i].low, parameters[i].high);
  other.ingredients.push_back(std::move(form));
  VectorXd there(before.size() + values.size());
  there << before, values;
  there = with_stiffness_of(fitted.form.realise(fitted.p), other, std::move(there));
  return std::pair{std::move(other), std::move(there)};
}

/// One of the last effect's numbers that `plainer` does without is off its null by more than five
/// standard deviations: that is worth 25/2 of log-likelihood, and two numbers cost log N.
bool pays_for_itself(const Fitted& fitted, const Ingredient& plainer) {
  constexpr double kDeviations = 5.0;
  const auto kept = plainer.parameters(), all = fitted.form.ingredients.back()->parameters();
  const Eigen::Index first = fitted.p.size() - static_cast<Eigen::Index>(all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    if (std::any_of(kept.begin(), kept.end(), [&](auto& p) { return p.name == all[i].name; }))
      continue;
    const Eigen::Index k = first + static_cast<Eigen::Index>(i);
    const double deviation = 0.5 * (fitted.high[k] - fitted.low[k]) / kNormal95;
    if (std::abs(fitted.p[k] - all[i].value) > kDeviations * deviation) return true;
  }
  return false;
}

/// The plainer form of the last effect where what it does without does not pay for itself
/// (refit_score), else `fitted`.
std::variant<Fitted, NumericalFailure> fit_plainest(Workspace& workspace, Fitted fitted,
                                                    const FitOptions& options) {
  const auto other = with_other_form(fitted, &Effect::plainer_form);
  if (!other || pays_for_itself(fitted, *other->first.ingredients.back())) return fitted;
  auto second = fit(workspace, other->first, other->second, warm(options));
  if (const auto* failure = std::get_if<NumericalFailure>(&second)) {
    if (cancelled(*failure)) return *failure;
    return fitted;
  }
  const Floor floor = measure_floor(workspace.scene(), fitted.evaluation);
  const Yardstick yardstick{&fitted, &floor, measured_noise2(fitted)};
  return refit_score(std::get<Fitted>(second), yardstick) >= refit_score(fitted, yardstick)
             ? second
             : fitted;
}

/// Fits; then the smaller form of the last effect, where it has one, from where the larger ended.
/// The smaller one is kept where it misses no more. The plainer form of either comes last.
std::variant<Fitted, NumericalFailure> fit_smallest(Workspace& workspace, const ModelForm& form,
                                                    const VectorXd& start,
                                                    const FitOptions& options) {
  auto result = fit(workspace, form, start, warm(options));
  auto* larger = std::get_if<Fitted>(&result);
  if (!larger) return result;
  const auto other = with_other_form(*larger, &Effect::smaller_form);
  if (!other) return fit_plainest(workspace, std::move(*larger), options);
  // far from there: coarse to fine
  auto second = fit(workspace, other->first, other->second, options);
  if (const auto* failure = std::get_if<NumericalFailure>(&second)) {
    if (cancelled(*failure)) return *failure;
    return fit_plainest(workspace, std::move(*larger), options);
  }
  Fitted& smaller = std::get<Fitted>(second);
  return fit_plainest(workspace, std::move(misfit(smaller) <= misfit(*larger) ? smaller : *larger),
                      options);
}

/// After its second step, or where it stands if there is none.
const Trial& newest(const Racer& racer) { return racer.next ? *racer.next : racer.trial; }

/// Which of two forms of an effect gets farther on fitted and held-out photos together; one that
/// takes from the fitted ones not half of what the other does gets nowhere, and has spoilt no
/// held-out photo for that alone.
bool gets_farther(const Racer& one, const Racer& other, const TrialScale& scale) {
  const auto taken = [&](const Racer& racer) {
    return scale.chi * scale.chi - std::pow(newest(racer).chi_fit, 2);
  };
  if (taken(one) < 0.5 * taken(other)) return false;
  if (taken(other) < 0.5 * taken(one)) return true;
  const auto chi = [](const Racer& racer) {
    return newest(racer).chi_fit + newest(racer).chi_validate;
  };
  return chi(one) < chi(other);
}

/// Steps once more from where the racer stands.
std::variant<Trial, NumericalFailure> step_on(Workspace& workspace, const Racer& racer,
                                              const TrialScale& scale, const FitOptions& options) {
  if (racer.next) return *racer.next;
  return try_step(workspace, racer.form, racer.trial.p, scale, options);
}

/// One Gauss-Newton step with the effect from its linear step; of its two forms, where there are
/// two, the one that gets farther on fitted and held-out photos together in two: one step from afar
/// is luck where both fit.
std::variant<Racer, NumericalFailure> enter(Workspace& workspace, const Fitted& current,
                                            const EffectScore& score, const TrialScale& scale,
                                            const FitOptions& options) {
  std::variant<Racer, NumericalFailure> best = NumericalFailure{"", 0.0, "no start"};
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
    if (auto* failure = std::get_if<NumericalFailure>(&result)) {
      if (form == &score || cancelled(*failure)) best = *failure;
      if (cancelled(*failure)) break;
      continue;
    }
    Racer racer{score.effect, std::move(started), std::get<Trial>(std::move(result)), {}};
    auto* other = std::get_if<Racer>(&best);
    if (other)
      for (Racer* one : {other, &racer}) {
        auto further = step_on(workspace, *one, scale, options);
        if (const auto* failure = std::get_if<NumericalFailure>(&further)) {
          if (cancelled(*failure)) return *failure;
        } else {
          one->next = std::get<Trial>(std::move(further));
        }
      }
    if (!other || gets_farther(racer, *other, scale)) best = std::move(racer);
  }
  return best;
}

/// Photos of `left` keep at most a tenth of what `start` had over the floor, fitted and held-out.
bool explains_nearly_all(const Trial& left, const TrialScale& start) {
  const double floor2 = start.floor * start.floor;
  const auto nearly = [&](double after, double before) {
    return after * after - floor2 <= 0.1 * std::max(0.0, before * before - floor2);
  };
  return nearly(left.chi_fit, start.chi) && nearly(left.chi_validate, start.chi_validate);
}

/// The first explains nearly all, and this one promises less than half of what the first did and
/// would be out of its reach with that: it could only come from there to tie, as a double whose
/// first step does not look like it. Not asked of what moves no photo.
bool no_rival(const EffectScore& score, const Diagnosis& diagnosis, const Racer& first,
              const TrialScale& start) {
  const EffectScore& led = diagnosis.effects.front();
  if (first.effect != led.effect || !explains_nearly_all(newest(first), start) ||
      sensors_alone(*score.best) || ties_with_first(diagnosis, score.effect) ||
      score.explains > 0.5 * led.explains)
    return false;
  const double chi2 = start.chi * start.chi, floor2 = start.floor * start.floor;
  return std::sqrt(chi2 - score.explains * (chi2 - floor2)) > 3.0 * newest(first).chi_fit;
}

}  // namespace

bool ties_with_first(const Diagnosis& diagnosis, const std::string& effect) {
  return std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const auto& score) {
    return score.effect == effect && score.evidence > diagnosis.effects.front().evidence - kTie;
  });
}

double Racer::structured() const {
  const double f2 = trial.floor * trial.floor, least = kLeftByRenderers * kLeftByRenderers - 1.0;
  const auto over = [&](double chi) { return std::sqrt(std::max(chi * chi - f2, least * f2)); };
  return over(trial.chi_fit) + (trial.chi_validate > 0.0 ? over(trial.chi_validate) : 0.0);
}

std::variant<Fitted, NumericalFailure> add_effect(Workspace& workspace, const Fitted& current,
                                                  const EffectScore& score,
                                                  const FitOptions& options) {
  if (score.other_form) {
    const auto scale = trial_scale(workspace, current.form, current.p, options);
    if (auto* failure = std::get_if<NumericalFailure>(&scale)) return *failure;
    const auto entered = enter(workspace, current, score, std::get<TrialScale>(scale), options);
    if (const auto* racer = std::get_if<Racer>(&entered)) return refit(workspace, *racer, options);
    if (cancelled(std::get<NumericalFailure>(entered))) return std::get<NumericalFailure>(entered);
  }
  const Model model = current.form.realise(current.p);
  if (auto remeshing = remeshing_form(model, score.best, score.values))
    return fit_on_its_mesh(workspace, model, remeshing, options);
  return from_shares(current, score, options, [&](const Extension& extension) {
    return fit_smallest(workspace, extension.form, extension.start, options);
  });
}

std::variant<std::vector<Racer>, NumericalFailure> race(
    Workspace& workspace, const Fitted& current, const Diagnosis& diagnosis,
    const FitOptions& options, const std::function<void(const Racer&)>& tried) {
  std::vector<Racer> racers;
  const auto scale = trial_scale(workspace, current.form, current.p, options);
  if (auto* failure = std::get_if<NumericalFailure>(&scale)) return *failure;
  for (const EffectScore& score : diagnosis.effects) {
    if (!nameable(score, diagnosis)) continue;
    if (!racers.empty() && no_rival(score, diagnosis, racers.front(), std::get<TrialScale>(scale)))
      continue;
    auto entered = enter(workspace, current, score, std::get<TrialScale>(scale), options);
    if (auto* failure = std::get_if<NumericalFailure>(&entered)) {
      if (cancelled(*failure)) return *failure;
      continue;
    }
    racers.push_back(std::get<Racer>(std::move(entered)));
    if (tried) tried(racers.back());
    if (racers.size() > 1 || &score == &diagnosis.effects.back()) continue;
    // The first is asked for its second step at once: who need not run shows then.
    auto further = step_on(workspace, racers.front(), std::get<TrialScale>(scale), options);
    if (auto* trial = std::get_if<Trial>(&further))
      racers.front().next = std::move(*trial);
    else if (cancelled(std::get<NumericalFailure>(further)))
      return std::get<NumericalFailure>(further);
  }
  auto sort = [&] {
    std::stable_sort(racers.begin(), racers.end(),
                     [](const Racer& a, const Racer& b) { return a.chi() < b.chi(); });
  };
  sort();
  const Racer first = racers.empty() ? Racer() : racers.front();
  for (size_t i = 0; i < racers.size() && (racers.size() > 1 || first.next); ++i) {
    // What the evidence puts first is refitted whatever comes: one step from afar may mislead.
    const std::string& effect = racers[i].effect;
    if (effect != diagnosis.effects.front().effect &&
        (i >= kSecondRound ||
         (racers[i].out_of_reach_of(first) && !ties_with_first(diagnosis, effect))))
      continue;
    auto result = step_on(workspace, racers[i], std::get<TrialScale>(scale), options);
    if (auto* failure = std::get_if<NumericalFailure>(&result)) {
      if (cancelled(*failure)) return *failure;
      continue;
    }
    racers[i].trial = std::get<Trial>(std::move(result));
    if (tried) tried(racers[i]);
  }
  sort();
  return racers;
}

std::variant<Fitted, NumericalFailure> refit(Workspace& workspace, const Racer& racer,
                                             const FitOptions& options) {
  const auto& scored = racer.form.ingredients.back();
  const auto added = static_cast<Eigen::Index>(scored->parameters().size());
  ModelForm before = racer.form;
  before.ingredients.pop_back();
  const Model model = before.realise(racer.trial.p.head(racer.trial.p.size() - added));
  if (auto remeshing = remeshing_form(model, scored, racer.trial.p.tail(added)))
    return fit_on_its_mesh(workspace, model, remeshing, options);
  return fit_smallest(workspace, racer.form, racer.trial.p, options);
}

}  // namespace hookeye
