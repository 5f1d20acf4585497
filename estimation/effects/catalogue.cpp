// The list of effects; catalogue.def is the only place that names them.
#include "estimation/effects/catalogue.h"

namespace hookeye {

#define HOOKEYE_EFFECT(NAME) const Effect& effect_##NAME();
#include "estimation/effects/catalogue.def"
#undef HOOKEYE_EFFECT

const Catalogue& catalogue() {
  static const Catalogue all({
#define HOOKEYE_EFFECT(NAME) &effect_##NAME(),
#include "estimation/effects/catalogue.def"
#undef HOOKEYE_EFFECT
  });
  return all;
}

}  // namespace hookeye
