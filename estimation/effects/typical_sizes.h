// How large the effects are as a rule, before any photo is looked at: typical_sizes.def.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/parameter.h"

namespace hookeye {

/// One line of the table.
struct TypicalSize {
  std::string effect;
  std::string
      parameter;  ///< last part of its name without a number: "angle" of "angle1"; "any": every one
  double size = 0.0;  ///< standard deviation of a normal density about the null
  /// The parameter's own; "typical": times Parameter::typical, which knows the scale of body and
  /// material; "log": of the logarithm of a positive parameter, about that of Parameter::typical.
  std::string unit;
  std::string reason, source;
};
const std::vector<TypicalSize>& typical_sizes();

/// Prior of a parameter in the units of a fit: log p of positive ones, p / typical of others.
struct SizePrior {
  double mean = 0.0, deviation = 1.0;
  bool one_sided = false;  ///< half a normal density: the parameter may only grow from its null
};
/// Empty: nothing is declared of it.
std::optional<SizePrior> size_prior(const std::string& effect, const Parameter& parameter);

}  // namespace hookeye
