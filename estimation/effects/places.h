// Several places of one effect in one model: a variant and parameters that tell which they are.
#pragma once

#include "estimation/model/effect.h"

namespace hookeye {

/// "free ball, place 2": a form and which of several places it is.
struct PlaceVariant {
  std::string form;
  int place = 1;  ///< 1 where nothing says so
};
PlaceVariant place_variant(const std::string& variant);
/// The variant's text; place 1 stays plain.
std::string as_place(const std::string& form, int place);
/// "EFFECT.a" as "EFFECT.place2.a"; of place 1 they stay plain.
std::vector<Parameter> of_place(std::vector<Parameter> parameters, int place);
/// The number after the largest that a parameter of `standing` has.
int next_place(const Ingredients& standing);

}  // namespace hookeye
