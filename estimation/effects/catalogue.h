// All effects. Files above this folder ask here; those below it are handed the catalogue.
#pragma once

#include <string>

#include "estimation/model/effect.h"

namespace hookeye {

/// Effects in the order of catalogue.def.
const Catalogue& catalogue();
/// Null: no effect of this name.
inline const Effect* find_effect(const std::string& name) { return catalogue().find(name); }

}  // namespace hookeye
