#include "estimation/model/limits.h"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>

#include "capture_io/yaml_section.h"

namespace hookeye {

namespace {

/// Calls visit(spec, number) for every number of `limits`.
template <class Limits_, class Visit>
void for_each(Limits_& limits, const Visit& visit) {
  const Limits standard;
#define LIMIT(type, name, value, low, high, unit, what, source)                                   \
  visit(LimitSpec{fmt::format("{}.{}", group, #name), double(own.name), double(of_standard.name), \
                  low, high, std::is_same_v<type, int>, unit, what, source},                      \
        own.name);
  const auto fit = [&](const char* group, auto& own, const auto& of_standard) {
#include "estimation/model/limits/fit.def"
  };
  const auto floor = [&](const char* group, auto& own, const auto& of_standard) {
#include "estimation/model/limits/floor.def"
  };
  const auto diagnosis = [&](const char* group, auto& own, const auto& of_standard) {
#include "estimation/model/limits/diagnosis.def"
  };
  const auto search = [&](const char* group, auto& own, const auto& of_standard) {
#include "estimation/model/limits/search.def"
  };
#undef LIMIT
  fit("fit", limits.fit, standard.fit);
  floor("floor", limits.floor, standard.floor);
  diagnosis("diagnosis", limits.diagnosis, standard.diagnosis);
  search("search", limits.search, standard.search);
}

}  // namespace

std::vector<LimitSpec> specs(const Limits& limits) {
  std::vector<LimitSpec> out;
  for_each(limits, [&](LimitSpec spec, const auto&) { out.push_back(std::move(spec)); });
  return out;
}

void set_limit(Limits& limits, const std::string& name, double value, const std::string& place) {
  bool found = false;
  std::vector<std::string> known;
  for_each(limits, [&](const LimitSpec& spec, auto& number) {
    known.push_back(spec.name);
    if (spec.name != name) return;
    found = true;
    const bool fits =
        value >= spec.low && value <= spec.high && (!spec.whole || value == std::floor(value));
    if (!fits)
      throw InputError(
          {place}, fmt::format("{} = {:g} is out of range", name, value),
          fmt::format("a{} number from {:g} to {:g} {}; {}: {}", spec.whole ? " whole" : "",
                      spec.low, spec.high, spec.unit, spec.name, spec.what));
    number = static_cast<std::remove_reference_t<decltype(number)>>(value);
  });
  if (!found)
    throw InputError({place}, fmt::format("there is no option `{}`", name), suggest(name, known));
}

std::map<std::string, double> changed(const Limits& limits) {
  std::map<std::string, double> out;
  for (const LimitSpec& spec : specs(limits))
    if (spec.value != spec.standard) out[spec.name] = spec.value;
  return out;
}

}  // namespace hookeye
