#include "estimation/search/extension.h"

#include <algorithm>

#include "estimation/effects/catalogue.h"
#include "estimation/fit/trial.h"

namespace hookeye {

const Effect* remeshed_by(const Ingredient& ingredient) {
  const Effect* effect = find_effect(ingredient.name());
  return effect && effect->remeshes(ingredient.variant()) ? effect : nullptr;
}

std::pair<ModelForm, VectorXd> on_its_mesh(const Model& model, const Ingredient& remeshing) {
  const Effect& effect = *remeshed_by(remeshing);
  auto [form, start] =
      transfer(model, effect.refit_scene(*model.scene, remeshing.variant()), catalogue());
  form.ingredients.push_back(effect.rebuild(form.realise(start), remeshing.variant()));
  VectorXd all = form.initial();
  all.head(start.size()) = start;
  return {std::move(form), std::move(all)};
}

void work_out_anew(ModelForm& form, const VectorXd& p) {
  ModelForm so_far = form;
  so_far.ingredients.clear();
  for (auto& ingredient : form.ingredients) {
    if (const Effect* effect = remeshed_by(*ingredient))
      ingredient = effect->rebuild(so_far.realise(p.head(so_far.size())), ingredient->variant());
    so_far.ingredients.push_back(ingredient);
  }
}

std::pair<std::shared_ptr<const Ingredient>, VectorXd> entering(const Model& model,
                                                                const EffectScore& score,
                                                                double share) {
  const auto scored = score.best->parameters();
  VectorXd nulls(score.values.size());
  for (int i = 0; i < nulls.size(); ++i) nulls[i] = scored[i].value;
  const VectorXd linear = nulls + share * (score.values - nulls);
  auto [ingredient, values, by_way_of, same_claim] =
      find_effect(score.effect)->refit_form(model, score.best, linear);
  if (remeshed_by(*ingredient)) {  // what the other mesh changes, linear, stands for it here
    ingredient = score.best;
    values = linear;
  }
  const auto parameters = ingredient->parameters();
  for (int i = 0; i < values.size(); ++i)
    values[i] = std::clamp(values[i], parameters[i].low, parameters[i].high);
  return {std::move(ingredient), std::move(values)};
}

namespace {

/// No further than one Gauss-Newton step of a trial goes (bounded_step).
VectorXd moved(const Fitted& current, const VectorXd& change) {
  if (change.size() != current.p.size()) return current.p;  // read from a run that did not say
  const Scaling scaling{current.form.parameters()};
  return bounded_step(scaling, current.p, change.cwiseQuotient(scaling.dp_dx(current.p)));
}

}  // namespace

Extension::Extension(const Fitted& current, const EffectScore& score, double share)
    : form(current.form) {
  auto [ingredient, values] = entering(realised(current), score, share);
  form.ingredients.push_back(std::move(ingredient));
  start.resize(current.p.size() + values.size());
  start << moved(current, share * score.base_step), values;
}

bool starts_anywhere(const Fitted& current, const EffectScore& score) {
  return Extension(current, score, 1.0).start == Extension(current, score, 0.0).start;
}

}  // namespace hookeye
