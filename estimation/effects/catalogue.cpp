// The list of effects; catalogue.def is the only place that names them.
#include "estimation/effects/catalogue.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>

#include "estimation/effects/session_effects.h"

namespace hookeye {

#define HOOKEYE_EFFECT(NAME) const Effect& effect_##NAME();
#include "estimation/effects/catalogue.def"
#undef HOOKEYE_EFFECT

namespace {

const Catalogue& built_in() {
  static const Catalogue all({
#define HOOKEYE_EFFECT(NAME) &effect_##NAME(),
#include "estimation/effects/catalogue.def"
#undef HOOKEYE_EFFECT
  });
  return all;
}

/// What was added. Catalogues and effects of before are kept: whoever works with one goes on. So
/// is this, at the program's end: an interpreter that its effects belong to is gone by then.
struct Added {
  struct One {
    const Effect* effect;
    std::string code;
  };
  std::mutex mutex;
  std::vector<One> now;
  std::vector<std::shared_ptr<const Effect>> effects;
  std::vector<std::unique_ptr<const Catalogue>> catalogues;
  std::atomic<const Catalogue*> current{&built_in()};

  /// With the mutex held.
  void renew() {
    std::vector<const Effect*> all(built_in().begin(), built_in().end());
    for (const One& one : now) all.push_back(one.effect);
    catalogues.push_back(std::make_unique<const Catalogue>(std::move(all)));
    current = catalogues.back().get();
  }
};

Added& added() {
  static Added* const all = new Added;
  return *all;
}

auto named(std::vector<Added::One>& all, const std::string& name) {
  return std::find_if(all.begin(), all.end(),
                      [&](const Added::One& one) { return one.effect->name() == name; });
}

}  // namespace

const Catalogue& catalogue() { return *added().current; }

void add_to_catalogue(std::shared_ptr<const Effect> effect, const std::string& code) {
  if (built_in().find(effect->name()))
    throw std::invalid_argument("there is an effect '" + effect->name() + "' already");
  Added& all = added();
  const std::lock_guard lock(all.mutex);
  const auto known = named(all.now, effect->name());
  if (known != all.now.end())
    *known = {effect.get(), code};
  else
    all.now.push_back({effect.get(), code});
  all.effects.push_back(std::move(effect));
  all.renew();
}

bool take_from_catalogue(const std::string& name) {
  Added& all = added();
  const std::lock_guard lock(all.mutex);
  const auto known = named(all.now, name);
  if (known == all.now.end()) return false;
  all.now.erase(known);
  all.renew();
  return true;
}

std::vector<std::string> added_to_catalogue() {
  Added& all = added();
  const std::lock_guard lock(all.mutex);
  std::vector<std::string> out;
  for (const Added::One& one : all.now) out.push_back(one.effect->name() + " " + one.code);
  return out;
}

}  // namespace hookeye
