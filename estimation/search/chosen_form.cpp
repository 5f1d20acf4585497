#include "estimation/search/chosen_form.h"

#include <algorithm>

#include "estimation/effects/catalogue.h"
#include "estimation/model/declaration.h"
#include "estimation/search/extension.h"
#include "estimation/search/kept_stiffness.h"

namespace hookeye {

namespace {

/// The effect, as if it had no other forms to be scored than those of one name.
class InOneForm : public Effect {
 public:
  InOneForm(const Effect& effect, std::string form) : effect_(effect), form_(std::move(form)) {}
  std::string name() const override { return effect_.name() + " as " + form_; }
  EffectGroup group() const override { return effect_.group(); }
  std::string title() const override { return effect_.title(); }
  std::string manual() const override { return effect_.manual(); }
  bool several() const override { return effect_.several(); }
  Ingredients candidates(const Model& model, std::string* why_not) const override {
    Ingredients out = effect_.candidates(model, why_not);
    std::erase_if(out, [&](const auto& one) { return form_name(one->variant()) != form_; });
    return out;
  }
  std::string sentence(const Model& model, const Ingredient& ingredient,
                       const VectorXd& values) const override {
    return effect_.sentence(model, ingredient, values);
  }

 private:
  const Effect& effect_;
  std::string form_;
};

VectorXd within_bounds(const Ingredient& form, VectorXd values) {
  const auto parameters = form.parameters();
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const Parameter& p = parameters[static_cast<size_t>(i)];
    values[i] = std::clamp(values[i], p.low, p.high);
  }
  return values;
}

Result<Fitted> as_scored(Workspace& workspace, const Fitted& current, const Effect& effect,
                         const std::string& form, const FitOptions& options,
                         DiagnosisOptions diagnosis) {
  const InOneForm narrowed(effect, form);
  diagnosis.also = {&narrowed};
  for (const Effect* other : catalogue()) diagnosis.without.push_back(other->name());
  auto scored = diagnose(workspace, current, diagnosis);
  if (!scored) return failure_of(scored);
  const EffectScore& score = scored->effects.front();
  if (!score.best) return no_result({"", 0.0, form + ": " + score.why_not});
  ModelForm with = current.form;
  with.ingredients.push_back(score.best);
  const auto parameters = score.best->parameters();
  VectorXd nulls(score.values.size());
  for (Eigen::Index i = 0; i < nulls.size(); ++i)
    nulls[i] = parameters[static_cast<size_t>(i)].value;
  Result<Fitted> result = no_result({});
  // The linear step is a direction more than a length (from_shares).
  for (const double share : {1.0, 0.3, 0.1, 0.0}) {
    VectorXd start(current.p.size() + nulls.size());
    start << current.p, within_bounds(*score.best, nulls + share * (score.values - nulls));
    result = fit(workspace, with, start, options);
    if (result || cancelled(result.error())) break;
  }
  return result;
}

/// Where a refit came to, or would go on from.
struct Reached {
  std::shared_ptr<const Ingredient> form;
  VectorXd values;
};

/// All forms that the effect goes on to from there, wider ones first.
std::vector<NextForm> onward(const Effect& effect, const Model& without, const Reached& from) {
  std::vector<NextForm> out;
  for (const FormEdge edge : {FormEdge::further, FormEdge::smaller, FormEdge::plainer})
    for (NextForm& next : effect.forms_from(edge, without, *from.form, from.values))
      out.push_back(std::move(next));
  return out;
}

/// The last effect of `fitted` in another form, fitted.
Result<Fitted> in_form(Workspace& workspace, const Fitted& fitted, const Reached& other,
                       const FitOptions& options) {
  const ParameterLayout at = fitted.form.layout();
  ModelForm form = fitted.form;
  form.ingredients.back() = other.form;
  VectorXd start = at.with(fitted.p, at.last(), within_bounds(*other.form, other.values));
  start = with_stiffness_of(fitted.form.realise(fitted.p), form, std::move(start));
  return fit(workspace, form, start, options);
}

VectorXd last_values(const Fitted& fitted) {
  const ParameterLayout at = fitted.form.layout();
  return at.of(fitted.p, at.last());
}

Result<Fitted> further(Workspace& workspace, const Fitted& fitted, const NextForm& to,
                       const FitOptions& options) {
  if (!to.by_way_of) return in_form(workspace, fitted, {to.form, to.values}, options);
  auto way = in_form(workspace, fitted, {to.by_way_of, to.values}, options);
  if (!way) return way;
  return in_form(workspace, *way, {to.form, last_values(*way)}, options);
}

}  // namespace

std::vector<std::string> form_names(const Effect& effect, const Model& model) {
  std::vector<std::string> out;
  for (const DeclaredForm& form : declare(effect, model).forms) {
    const std::string name = form_name(form.variant);
    if (!name.empty() && std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  }
  return out;
}

Result<Fitted> add_effect_as(Workspace& workspace, const Fitted& current, const EffectScore& score,
                             const std::string& form, const FitOptions& options,
                             const DiagnosisOptions& diagnosis) {
  const Effect& effect = *find_effect(score.effect);
  const auto forms = declare(effect, current.form.realise(current.p)).forms;
  const bool by_refit = std::any_of(forms.begin(), forms.end(), [&](const DeclaredForm& one) {
    return one.refit && form_name(one.variant) == form;
  });
  if (!by_refit) return as_scored(workspace, current, effect, form, options, diagnosis);
  auto fitted = add_effect(workspace, current, score, options);
  if (!fitted || form_name(fitted->form.ingredients.back()->variant()) == form) return fitted;

  ModelForm before = fitted->form;
  before.ingredients.pop_back();
  const VectorXd own = last_values(*fitted);
  Model without = before.realise(fitted->p.head(before.size()));
  without.states = realised(*fitted).states;
  const auto wanted = [&](const NextForm& one) { return form_name(one.form->variant()) == form; };
  const auto first = onward(effect, without, {fitted->form.ingredients.back(), own});
  for (const NextForm& one : first)
    if (wanted(one)) return further(workspace, *fitted, one, options);
  for (const NextForm& one : first)
    for (const NextForm& next : onward(effect, without, {one.form, one.values}))
      if (wanted(next)) return further(workspace, *fitted, next, options);
  return no_result({"", 0.0,
                    "the refit ended as '" + fitted->form.ingredients.back()->variant() +
                        "', from which no way leads to '" + form + "'"});
}

}  // namespace hookeye
