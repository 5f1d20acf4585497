#include "estimation/model/declaration.h"

#include <deque>
#include <map>
#include <regex>

namespace hookeye {

namespace {

/// The variant with every number in it struck: what its form is, wherever it stands. Digits within
/// a name ("cam0") stay.
std::string kind_of(const std::string& variant) {
  static const std::regex number(R"(-?\b\d+(\.\d+)?(e[-+]?\d+)?\b)");
  return std::regex_replace(variant, number, "#");
}

/// Collects forms by kind, and those that they lead to.
class Forms {
 public:
  Forms(const Effect& effect, const Model& model) : effect_(effect), model_(model) {}

  /// A form of the scored ones, or of those that a refit goes on to from one seen before.
  void take(const std::shared_ptr<const Ingredient>& form, const VectorXd& values, bool refit) {
    if (!form) return;
    const auto [at, fresh] = seen_.try_emplace(kind_of(form->variant()), all_.size());
    if (!fresh) {
      all_[at->second].ways += all_[at->second].refit == refit;
      return;
    }
    all_.push_back({form->variant(), 1, refit, form->parameters(),
                    effect_.sentence(model_, *form, typical_values(*form))});
    open_.push_back({form, values, refit});
  }

  std::vector<DeclaredForm> with_refits() {
    while (!open_.empty()) {
      const Open one = open_.front();
      open_.pop_front();
      if (!one.refit) go_on_from(one, FormEdge::refit);
      for (const FormEdge edge : {FormEdge::further, FormEdge::smaller, FormEdge::plainer})
        go_on_from(one, edge);
    }
    for (DeclaredForm& form : all_)
      if (form.refit) form.ways = 1;
    return std::move(all_);
  }

 private:
  struct Open {
    std::shared_ptr<const Ingredient> form;
    VectorXd values;
    bool refit;
  };

  void go_on_from(const Open& one, FormEdge edge) {
    for (const NextForm& next : effect_.forms_from(edge, model_, *one.form, one.values))
      take(next.form, next.values, true);
  }

  const Effect& effect_;
  const Model& model_;
  std::map<std::string, size_t> seen_;
  std::deque<Open> open_;
  std::vector<DeclaredForm> all_;
};

}  // namespace

std::string form_name(const std::string& variant) {
  // The words before the first number, without those that lead to one.
  static const std::regex leading(
      R"([ ,(]+(radius|around|across|along|towards|about|position|stiffness|times)$)");
  std::string name = kind_of(variant);
  if (const size_t number = name.find('#'); number != std::string::npos) {
    const auto trim = [&] { name.resize(name.find_last_not_of(" ,(") + 1); };
    name.resize(number);
    for (size_t before = name.size() + 1; name.size() < before;) {
      before = name.size();
      trim();
      name = std::regex_replace(name, leading, "");
    }
  }
  const std::string free = "free ";
  return name.starts_with(free) ? name.substr(free.size()) : name;
}

std::string group_name(EffectGroup group) {
  switch (group) {
    case EffectGroup::material:
      return "material";
    case EffectGroup::loads:
      return "loads";
    case EffectGroup::supports:
      return "supports";
    case EffectGroup::history:
      return "history";
    case EffectGroup::measurement:
      return "measurement";
    default:
      return "numerical";
  }
}

VectorXd typical_values(const Ingredient& ingredient) {
  const auto parameters = ingredient.parameters();
  VectorXd values(parameters.size());
  for (size_t i = 0; i < parameters.size(); ++i) {
    values[i] = parameters[i].value + parameters[i].typical;
    if (values[i] > parameters[i].high) values[i] = parameters[i].value - parameters[i].typical;
  }
  return values;
}

Declaration declare(const Effect& effect, const Model& model) {
  Declaration out{&effect, {}, {}};
  Forms forms(effect, model);
  const Ingredients scored = effect.candidates(model, &out.why_not);
  for (const auto& one : scored) forms.take(one, typical_values(*one), false);
  out.forms = forms.with_refits();
  if (!out.forms.empty()) out.why_not.clear();
  return out;
}

}  // namespace hookeye
