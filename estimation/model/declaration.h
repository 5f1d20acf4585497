// What the effects of the catalogue say of themselves in one model: for `hookeye effects` and
// docs/effects.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "estimation/model/effect.h"

namespace hookeye {

/// "material", "loads", ...
std::string group_name(EffectGroup group);

/// Each value one typical change off its null, to a side that its bounds allow.
VectorXd typical_values(const Ingredient& ingredient);

/// What a form is called, wherever it stands and whether or not a refit frees its place: "ball" of
/// "free ball", "blob" of "blob around (0, 0, 20), radius 7". Empty: it has no name.
std::string form_name(const std::string& variant);

/// Variants that differ in numbers alone: a direction, a place.
struct DeclaredForm {
  std::string variant;                ///< the first of them; empty: the effect has one form
  int ways = 1;                       ///< how many there are
  bool refit = false;                 ///< not scored by a diagnosis: a refit may go on to it
  std::vector<Parameter> parameters;  ///< `value` is the null
  std::string sentence;               ///< with typical values
};

struct Declaration {
  const Effect* effect;
  std::string why_not;              ///< why it cannot be present here; empty where it can
  std::vector<DeclaredForm> forms;  ///< scored ones first, then those of a refit
};

/// All forms that the effect may take in this model, also by way of others.
Declaration declare(const Effect& effect, const Model& model);

/// A capture in which every effect of the catalogue can be present: a block of 20 x 16 x 40 mm,
/// clamped at its base; rest, pull, twist (rigid, measured force), bend, and press held out. Writes
/// capture.yaml and its files; photos are grey.
void write_example_block(const std::filesystem::path& folder);

}  // namespace hookeye
