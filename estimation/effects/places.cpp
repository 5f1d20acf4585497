#include "estimation/effects/places.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace hookeye {

namespace {

const std::string kPlace = ", place ", kPrefix = ".place";

}  // namespace

PlaceVariant place_variant(const std::string& variant) {
  const size_t at = variant.rfind(kPlace);
  if (at == std::string::npos) return {variant};
  int place = 0;
  const char* const end = variant.data() + variant.size();
  const auto [stop, error] = std::from_chars(variant.data() + at + kPlace.size(), end, place);
  if (error != std::errc() || stop != end || place < 2) return {variant};
  return {variant.substr(0, at), place};
}

std::string as_place(const std::string& form, int place) {
  return place == 1 ? form : fmt::format("{}{}{}", form, kPlace, place);
}

std::vector<Parameter> of_place(std::vector<Parameter> parameters, int place) {
  if (place > 1)
    for (Parameter& one : parameters)
      one.name.insert(one.name.find('.'), fmt::format("{}{}", kPrefix, place));
  return parameters;
}

int next_place(const Ingredients& standing) {
  int last = 1;
  for (const auto& one : standing)
    for (const Parameter& parameter : one->parameters()) {
      const std::string& name = parameter.name;
      const size_t at = name.find(kPrefix);
      if (at == std::string::npos) continue;
      int place = 0;
      std::from_chars(name.data() + at + kPrefix.size(), name.data() + name.size(), place);
      last = std::max(last, place);
    }
  return last + 1;
}

}  // namespace hookeye
