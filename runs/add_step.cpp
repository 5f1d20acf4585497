#include "runs/add_step.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "estimation/effects/catalogue.h"
#include "estimation/model/declaration.h"
#include "estimation/search/chosen_form.h"
#include "runs/failed.h"

namespace hookeye {
namespace {

[[noreturn]] void unknown_effect(const std::string& wanted) {
  std::vector<std::string> known;
  for (const Effect* effect : catalogue()) known.push_back(effect->name());
  const std::string near = nearest_name(wanted, known);
  throw InputError({wanted}, "there is no such effect",
                   near.empty() ? fmt::format("one of: {}", fmt::join(known, ", "))
                                : fmt::format("did you mean '{}'?", near));
}

[[noreturn]] void there_already(const std::string& wanted) {
  throw InputError(
      {wanted}, "the newest step has this effect already",
      "add another one, or take this one back: `hookeye add RUN " + wanted + " --take-back`");
}

[[noreturn]] void not_there(const std::string& wanted, const std::vector<std::string>& effects) {
  throw InputError(
      {wanted}, "the newest step does not have this effect",
      effects.empty() ? "it has none, so nothing can be taken back"
                      : fmt::format("it has {}: take back one of these", fmt::join(effects, ", ")));
}

Step with_effect(Bench& bench, const Step& current, const AddRequest& request,
                 const AddOptions& options) {
  const std::string& name = request.effect;
  const bool tested =
      std::any_of(current.diagnosis.effects.begin(), current.diagnosis.effects.end(),
                  [&](const EffectScore& score) { return score.effect == name; });
  if (!tested && options.doing) options.doing("diagnosing the newest step");
  const Diagnosis diagnosis =
      tested ? current.diagnosis
             : value_or_fail(diagnose(bench.workspace, current.fitted, options.diagnosis));
  for (const auto& score : diagnosis.effects) {
    if (score.effect != name) continue;
    if (!score.best)
      throw InputError({name}, "this effect cannot be added: " + score.why_not,
                       "add another one; `hookeye diagnose RUN` ranks them");
    if (options.note) {
      if (!score.testable) options.note(name + ": " + score.why_not);
      options.note(
          fmt::format("predicted: removes {:.0f} % of the misfit", 100.0 * score.explains));
    }
    if (options.doing) options.doing("refitting");
    Step step;
    step.name = step.added = name;
    step.fitted = value_or_fail(
        request.form.empty() ? add_effect(bench.workspace, current.fitted, score, options.fit)
                             : add_effect_as(bench.workspace, current.fitted, score, request.form,
                                             options.fit, options.diagnosis));
    return step;
  }
  unknown_effect(name);
}

Step without_effect(Bench& bench, const Step& current, const std::string& name,
                    const AddOptions& wanted) {
  ModelForm form = current.fitted.form;
  const auto& all = current.fitted.form.ingredients;
  // the newest, where it stands more than once
  const auto newest =
      std::find_if(all.rbegin(), all.rend(), [&](const auto& one) { return one->name() == name; });
  if (newest == all.rend()) not_there(name, effects_in(current.fitted.form));
  const Effect* effect = find_effect(name);
  const bool mesh = effect && effect->remeshes((*newest)->variant());
  const auto at = static_cast<size_t>(all.rend() - newest) - 1;
  form.ingredients.erase(form.ingredients.begin() + static_cast<std::ptrdiff_t>(at));
  if (wanted.doing) wanted.doing("refitting");
  Step step;
  step.name = "without-" + name;
  FitOptions options = wanted.fit;
  options.coarse_to_fine = false;
  VectorXd start = current.fitted.form.layout().without(current.fitted.p, at);
  if (mesh) std::tie(form, start) = transfer(form.realise(start), bench.scene, catalogue());
  step.fitted = value_or_fail(fit(bench.workspace, form, start, options));
  return step;
}

}  // namespace

void check_effect(const std::string& name) {
  if (!find_effect(name)) unknown_effect(name);
}

void check_stands(const Run& run, const AddRequest& request) {
  const nlohmann::json& steps = run.timeline().at("steps");
  // Runs of earlier versions do not tell: then the model does, once it is read.
  if (steps.empty() || !steps.back().contains("effects")) return;
  const auto effects = steps.back().at("effects").get<std::vector<std::string>>();
  const bool there = std::find(effects.begin(), effects.end(), request.effect) != effects.end();
  if (request.take_back && !there) not_there(request.effect, effects);
  const Effect* effect = find_effect(request.effect);
  if (!request.take_back && there && !(effect && effect->several())) there_already(request.effect);
}

void check_form(const Fitted& current, const AddRequest& request) {
  const Effect* effect = find_effect(request.effect);
  if (request.form.empty() || !effect) return;
  if (request.take_back)
    throw InputError({request.form}, "an effect is taken back in the form that it has",
                     "leave `--as` out");
  const auto known = form_names(*effect, current.form.realise(current.p));
  if (std::find(known.begin(), known.end(), request.form) != known.end()) return;
  const std::string told = fmt::format("'{}'", fmt::join(known, "', '"));
  throw InputError({request.form}, fmt::format("{} has no such form in this model", request.effect),
                   known.empty() ? "it has one form alone: leave `--as` out" : "one of " + told);
}

std::string form_taken(const Fitted& fitted, const std::string& effect) {
  const auto& all = fitted.form.ingredients;
  const auto newest = std::find_if(all.rbegin(), all.rend(),
                                   [&](const auto& one) { return one->name() == effect; });
  const Effect* found = find_effect(effect);
  if (newest == all.rend() || !found) return {};
  ModelForm before = fitted.form;
  before.ingredients.resize(static_cast<size_t>(all.rend() - newest) - 1);
  auto others = form_names(*found, before.realise(fitted.p.head(before.size())));
  const std::string taken = form_name((*newest)->variant());
  std::erase(others, taken);
  if (taken.empty() || others.empty()) return {};
  return fmt::format("form:      {}; `--as FORM` takes another: '{}'", (*newest)->variant(),
                     fmt::join(others, "', '"));
}

Step next_step(Bench& bench, const Step& current, const AddRequest& request,
               const AddOptions& options) {
  check_form(current.fitted, request);
  return request.take_back ? without_effect(bench, current, request.effect, options)
                           : with_effect(bench, current, request, options);
}

}  // namespace hookeye
