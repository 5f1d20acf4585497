#include "estimation/model/model_key.h"

#include <algorithm>

namespace hookeye {

std::string FormKey::words() const {
  return variant.empty() ? name : name + " as '" + variant + "'";
}

FormKey key_of(const Ingredient& ingredient) { return {ingredient.name(), ingredient.variant()}; }

ModelKey::ModelKey(const ModelForm& form) {
  for (const auto& one : form.ingredients) forms_.push_back(key_of(*one));
  std::sort(forms_.begin(), forms_.end());
}

}  // namespace hookeye
