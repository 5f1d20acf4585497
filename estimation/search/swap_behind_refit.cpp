#include <algorithm>

#include "estimation/fit/at_floor.h"
#include "estimation/search/refit_score.h"
#include "estimation/search/swaps.h"

namespace hookeye {

std::optional<std::pair<const Refit*, Swap>> swap_behind_refit(
    Workspace& workspace, const std::vector<Refit>& refits, const Floor& floor, size_t first_effect,
    RefusedSwaps& refused, const DiscoverOptions& options, const DiscoverEvents& events) {
  if (std::any_of(refits.begin(), refits.end(),
                  [&](const Refit& refit) { return at_floor(refit.fitted, floor); }))
    return {};
  const auto found = std::find_if(refits.begin(), refits.end(), [&](const Refit& refit) {
    return spoils_held_out(refit.fitted, floor);
  });
  if (found == refits.end()) return {};
  auto swap =
      swap_for_better(workspace, found->fitted, floor, first_effect, refused, options, events);
  if (!swap) return {};
  const Yardstick yardstick{&swap->in.fitted, &floor, measured_noise2(swap->in.fitted)};
  swap->in.score = refit_score(swap->in.fitted, yardstick);
  if (std::any_of(refits.begin(), refits.end(), [&](const Refit& refit) {
        return refit_score(refit.fitted, yardstick) >
               swap->in.score - floor.limits->diagnosis.nameable;
      }))
    return {};
  return std::pair{&*found, std::move(*swap)};
}

}  // namespace hookeye
