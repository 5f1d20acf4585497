#include "estimation/effects/typical_sizes.h"

#include <algorithm>
#include <cmath>

namespace hookeye {

namespace {

/// "angle" of "load_direction.pull.angle1".
std::string last_part(const std::string& name) {
  std::string out = name.substr(name.rfind('.') + 1);
  // "k2" and "c2" are names of their own; fields number what is all of one meaning.
  while (out.size() > 1 && std::isdigit(static_cast<unsigned char>(out.back())) &&
         (out.starts_with("angle") || out.starts_with("tilt") || out.starts_with("a")))
    out.pop_back();
  return out;
}

}  // namespace

const std::vector<TypicalSize>& typical_sizes() {
#define SIZE(EFFECT, PARAMETER, VALUE, UNIT, REASON, SOURCE) \
  {#EFFECT, #PARAMETER, VALUE, UNIT, REASON, SOURCE},
  static const std::vector<TypicalSize> all = {
#include "estimation/effects/typical_sizes.def"
  };
#undef SIZE
  return all;
}

std::optional<SizePrior> size_prior(const std::string& effect, const Parameter& parameter) {
  const std::string last = last_part(parameter.name);
  const auto& all = typical_sizes();
  const auto found = std::find_if(all.begin(), all.end(), [&](const TypicalSize& one) {
    return one.effect == effect && (one.parameter == last || one.parameter == "any") &&
           (one.unit == "log") == parameter.positive;
  });
  if (found == all.end()) return std::nullopt;
  if (found->unit == "log") return SizePrior{std::log(parameter.typical), found->size, false};
  const double unit = found->unit == "typical" ? 1.0 : 1.0 / parameter.typical;
  return SizePrior{parameter.value / parameter.typical, found->size * unit,
                   parameter.low >= parameter.value};
}

}  // namespace hookeye
