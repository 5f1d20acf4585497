// Which model it is, whatever its numbers have been fitted to.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "estimation/model/model.h"

namespace hookeye {

/// An ingredient in one of its forms: "stiffness_field", "free ball".
struct FormKey {
  std::string name, variant;
  auto operator<=>(const FormKey&) const = default;
  /// "gravity"; "stiffness_field as 'free ball'".
  std::string words() const;
};

FormKey key_of(const Ingredient& ingredient);

/// A model by the forms of its ingredients, in whatever order they came to it. Its mesh is that of
/// the capture, or stands among the forms (mesh_resolution).
class ModelKey {
 public:
  explicit ModelKey(const ModelForm& form);
  auto operator<=>(const ModelKey&) const = default;

 private:
  std::vector<FormKey> forms_;  ///< sorted
};

}  // namespace hookeye
