// The list of effects; catalogue.def is the only place that names them.
#include "estimation/effect.h"

namespace hookeye {

#define HOOKEYE_EFFECT(NAME) const Effect& effect_##NAME();
#include "estimation/effects/catalogue.def"
#undef HOOKEYE_EFFECT

const std::vector<const Effect*>& catalogue() {
  static const std::vector<const Effect*> all = {
#define HOOKEYE_EFFECT(NAME) &effect_##NAME(),
#include "estimation/effects/catalogue.def"
#undef HOOKEYE_EFFECT
  };
  return all;
}

const Effect* find_effect(const std::string& name) {
  for (const Effect* effect : catalogue())
    if (effect->name() == name) return effect;
  return nullptr;
}

}  // namespace hookeye
