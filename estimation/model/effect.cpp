#include "estimation/model/effect.h"

namespace hookeye {

const Effect* Catalogue::find(const std::string& name) const {
  for (const Effect* effect : effects_)
    if (effect->name() == name) return effect;
  return nullptr;
}

std::shared_ptr<const Ingredient> Effect::candidate(const Model& model,
                                                    const std::string& variant) const {
  if (auto built = rebuild(model, variant)) return built;
  for (auto& one : candidates(model, nullptr))
    if (one->variant() == variant) return one;
  return nullptr;
}

Ingredients Effect::candidates_beside(const Model& model, const Ingredients&,
                                      std::string* why_not) const {
  if (several()) return candidates(model, why_not);
  if (why_not) *why_not = "already in the model";
  return {};
}

std::shared_ptr<const Ingredient> Effect::rebuild(const Model&, const std::string&) const {
  return nullptr;
}

bool Effect::remeshes(const std::string&) const { return false; }

std::shared_ptr<const Scene> Effect::refit_scene(const Scene&, const std::string&) const {
  return nullptr;
}

std::vector<NextForm> Effect::forms_from(FormEdge, const Model&, const Ingredient&,
                                         const Eigen::VectorXd&) const {
  return {};
}

std::optional<NextForm> Effect::form_from(FormEdge edge, const Model& model, const Ingredient& from,
                                          const Eigen::VectorXd& values) const {
  auto all = forms_from(edge, model, from, values);
  if (all.empty()) return std::nullopt;
  return std::move(all.front());
}

NextForm Effect::refit_form(const Model& model, const std::shared_ptr<const Ingredient>& scored,
                            const Eigen::VectorXd& values) const {
  auto larger = form_from(FormEdge::refit, model, *scored, values);
  return larger ? *std::move(larger) : NextForm{scored, values};
}

}  // namespace hookeye
