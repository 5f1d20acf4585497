// The form of a named effect made wider, before a second effect is asked for. Internal to discover.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>

#include "estimation/model/model_key.h"
#include "estimation/search/contest.h"

namespace hookeye {

/// Where an effect leaves more than the floor its form may be too narrow: what it leaves over looks
/// like another effect (method.md, "Which effect is missing", 6). The model with its ingredient
/// `at` in the best of its effect's further forms (FormEdge::further; where others came after
/// it, its smaller form too) and of theirs, or as it is. A form stays where it takes most of what
/// is over the floor (or says the same in another shape), where fitted and held-out photos together
/// pay for its parameters by more than a tie, and where the held-out ones do not speak against it:
/// else it is another effect that is missing. Of several such forms the one stays that says most.
/// Of what a wide form says a plainer one (FormEdge::plainer) stays where it scores as well.
/// `left_much`: of those that pay and leave too much for that, the one that says most, without its
/// pictures. Near the floor nothing wider is asked for, unless another effect stands out beside it
/// (`another_stands_out`).
Result<Fitted> widened(Workspace& workspace, Fitted narrow, size_t at, const Floor& floor,
                       const FitOptions& options, const DiscoverEvents& events = {},
                       std::optional<Fitted>* left_much = nullptr, bool another_stands_out = false);

/// An effect that only the larger form of another makes room for: without it, and with that other
/// in its smaller form (FormEdge::smaller), the photos stay at the floor and the score falls by
/// less than a tie. (A stiffness field within 3 % had stayed beside a wall that was fitted as a
/// soft cushion.) Told in the result: who leaves.
std::optional<Refit> drop_beside_smaller(Workspace& workspace, const Fitted& fitted,
                                         const Floor& floor, size_t first_effect,
                                         const FitOptions& options,
                                         const DiscoverEvents& events = {});

/// The same for all steps of a search: each form once beside the same others in their forms.
class WiderForms {
 public:
  WiderForms(Workspace& workspace, const FitOptions& options, const DiscoverEvents& events)
      : workspace_(workspace), options_(options), events_(events) {}
  /// Empty: none is better, or it was asked before.
  Result<std::optional<Fitted>> ask(const Fitted& fitted, size_t at, const Floor& floor,
                                    bool another_stands_out = false);
  /// A form that was asked of `now` and left much over the floor, where it says more than `winner`,
  /// which is `now` and another effect: what a named effect accounts for needs no second name.
  Result<std::optional<Fitted>> instead_of(const Refit& winner, const Fitted& now,
                                           const Floor& floor);
  /// The best refit explains the fitted photos and misses the held-out ones, and none explains
  /// both: before what stands is doubted for it, it is asked for a wider form, and the contest is
  /// ranked anew. (Creep that levels off is growing creep to the first loads.)
  Result<void> mend(Contest& contest, const Step& step, const Floor& floor);
  /// Who leads by evidence and lost the contest may have stood in a form that did not suit it (a
  /// ball for two halves): it is asked for its further forms, and the contest is ranked anew.
  Result<void> ask_leaders(Contest& contest, const Step& step, const Floor& floor);
  /// Widening came to this form: a plainer one may do at the floor.
  bool came_to(const Ingredient& form) const;

 private:
  struct LeftMuch {
    ModelKey asked;
    size_t at;
    Fitted fitted;
  };
  Workspace& workspace_;
  const FitOptions& options_;
  const DiscoverEvents& events_;
  std::vector<LeftMuch> left_much_;
  std::set<std::pair<ModelKey, FormKey>> asked_;
  std::set<FormKey> came_to_;
};

}  // namespace hookeye
