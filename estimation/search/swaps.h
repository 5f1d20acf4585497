// Effects of earlier steps that a later one shows to be idle or wrong. Internal to discover.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "estimation/model/model_key.h"
#include "estimation/search/contest.h"

namespace hookeye {

struct Parted {
  ModelForm form;
  VectorXd p;
};
/// `fitted` without its ingredient `i`, all else as it stands.
Parted parted_from(const Fitted& fitted, size_t i);

/// Drops an earlier effect (told in the result) that a later one made idle: one backward swap.
/// `first_effect`: how many ingredients the capture's own model has.
std::optional<Refit> backward(Workspace& workspace, const Fitted& current, const Floor& floor,
                              size_t first_effect, const DiscoverOptions& options);

/// An effect among several that is not supported: each of its intervals, which reach for a finer
/// mesh, holds its null, and without it the photos stay at the floor. It led the others out of a
/// place from which their own steps saw no way, or took up some of what the mesh errs by.
std::optional<Refit> drop_unsupported(Workspace& workspace, const Fitted& fitted,
                                      const Floor& floor, size_t first_effect,
                                      const DiscoverOptions& options);

/// Whether `rival`, which equalled the winner beside the effect `dropped`, equals it still now that
/// the winner does without: as it is, which costs that effect's parameters, or without it too.
bool equals_after_swap(Workspace& workspace, const Fitted& rival, const Fitted& winner,
                       const std::string& dropped, const Floor& floor, const FitOptions& options);

struct Swap {
  std::string out;  ///< the effect that left
  Refit in;         ///< the one that took its place, with all others
};

/// The step in which one effect took another's place.
Step swapped_step(Swap swap);

/// A swap that was asked for.
struct SwapKey {
  ModelKey model;
  FormKey out;
  std::string in;  ///< an effect
  auto operator<=>(const SwapKey&) const = default;
};

/// What came of swaps that were refused. What was asked behind a refit is not fitted again once
/// that refit stands, nor where a tie asks for it; beside other effects it is.
struct RefusedSwap {
  ModelForm form;
  VectorXd p;
};
using RefusedSwaps = std::map<SwapKey, RefusedSwap>;

/// Two effects or more are not enough: one of them may stand for another. It was chosen while the
/// others were missing, or is a double that only the held-out photos tell from the right one (creep
/// and softening, of two loads). Each is dropped, what leads then or ties with the leader is
/// refitted in its place, and the best of these is it if its score is higher by
/// DiagnosisLimits::nameable. Empty: none is, or the model is at the floor.
std::optional<Swap> swap_for_better(Workspace& workspace, const Fitted& fitted, const Floor& floor,
                                    size_t first_effect, RefusedSwaps& refused,
                                    const DiscoverOptions& options, const DiscoverEvents& events);

/// The same for the best of `refits` that explains the fitted photos alone, where none is at the
/// floor of both and with the swap it scores higher than all of them by DiagnosisLimits::nameable:
/// an effect added before, or its form, keeps the right one (or the mesh) from winning.
std::optional<std::pair<const Refit*, Swap>> swap_behind_refit(
    Workspace& workspace, const std::vector<Refit>& refits, const Floor& floor, size_t first_effect,
    RefusedSwaps& refused, const DiscoverOptions& options, const DiscoverEvents& events);

struct TieAsked {
  std::vector<std::string> tie;  ///< who equals the first of the tie still, with it; empty: nobody
  std::optional<Swap> better;    ///< the best of those that are better now, if any
};

/// What a tie comes to in the last model, where a later effect stands beside it: who was equal
/// while that was missing need not be. All of the tie race where its first is not in the model; who
/// is out of reach there, or behind where `last` is at the floor, is not refitted. Empty: it could
/// not be asked, as the model without the first of the tie has no equilibrium.
std::optional<TieAsked> ask_tie_again(Workspace& workspace, const Fitted& last,
                                      const std::vector<std::string>& tie, const Floor& floor,
                                      size_t first_effect, const RefusedSwaps& refused,
                                      const DiscoverOptions& options, const DiscoverEvents& events);

}  // namespace hookeye
