// Every number that a fit, a floor, a diagnosis or a search decides by, with unit, reason and
// source: limits/*.def. `hookeye discover --options` prints them, `--set NAME=VALUE` sets one.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace hookeye {

#define LIMIT(type, name, value, low, high, unit, what, source) type name = value;
struct FitLimits {
#include "estimation/model/limits/fit.def"
};
struct FloorLimits {
#include "estimation/model/limits/floor.def"
};
struct DiagnosisLimits {
#include "estimation/model/limits/diagnosis.def"
};
struct SearchLimits {
#include "estimation/model/limits/search.def"
};
#undef LIMIT

/// Shared by all that is made of a scene (Scene::limits).
struct Limits {
  FitLimits fit;
  FloorLimits floor;
  DiagnosisLimits diagnosis;
  SearchLimits search;
};

/// One of them, told.
struct LimitSpec {
  std::string name;  ///< "floor.at"
  double value = 0.0, standard = 0.0, low = 0.0, high = 0.0;
  bool whole = false;  ///< an integer
  std::string unit, what, source;
};
std::vector<LimitSpec> specs(const Limits& limits);

/// Sets one by its name. Throws InputError (`place`) for a name that is none, with the nearest, and
/// for a value out of its range.
void set_limit(Limits& limits, const std::string& name, double value, const std::string& place);

/// Those that are not at their standard value, by name: what a run keeps.
std::map<std::string, double> changed(const Limits& limits);

}  // namespace hookeye
