// One round of discover(): who is raced, who is refitted, how they rank. Internal to discover.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "estimation/search/discover.h"
#include "estimation/search/refit_score.h"

namespace hookeye {

/// A step of a search with this model; `dropped` left it.
Step step_with(std::string effect, Fitted fitted, std::vector<std::string> dropped = {});

/// Without its pictures, 80 MB of 14 photos of 0.5 Mpx: they are for who is told of a step, and
/// what is compared later is not compared by them.
void drop_pictures(Fitted& fitted);

/// The result of fit(), which is told to who watches, before it as `words` and after.
template <class Fit>
Result<Fitted> announced(const DiscoverEvents& events, const std::string& words, const Fit& fit) {
  if (events.refitting) events.refitting(words);
  Result<Fitted> result = fit();
  if (events.refitted) events.refitted(words, result);
  return result;
}

struct Refit {
  std::string effect;
  Fitted fitted;
  double score = 0.0;
};

struct Contest {
  std::vector<Racer> racers;     ///< all that ran, best first
  std::vector<Refit> refits;     ///< best first
  double before = 0.0;           ///< score of the step that they start from
  Fitted reference;              ///< whose correlation all scores are of
  double measured_noise2 = 1.0;  ///< Yardstick's
  /// Who leads by evidence (leads()) and could not be fitted in any form.
  std::vector<std::string> not_compared;
};

/// Scores the refits, of which there are some, on fitted and held-out photos with the correlation
/// of the best of them, and sorts them.
void rank(Contest& contest, const Step& step);

/// What the racers came to, for the step that is made of them.
std::vector<Raced> raced(const std::vector<Racer>& racers);

/// Who was refitted, and by how much each scores above `chosen`.
std::vector<Rival> rivals_of(const Contest& contest, double chosen);

/// refit_score of one less the other's, by the correlation of the one that misses less: what a
/// wrong effect leaves hangs together, and by that it counts for little.
double score_above(const Fitted& one, const Fitted& other, const Floor& floor);

/// Those that lost the contest of `then` by less of chi^2 than what later steps took away. (Not the
/// nearest alone: of creep and softening, which fit alike, held-out photos may refuse it.)
std::vector<std::string> narrow_losers(const Step& then, const Fitted& last);

/// Who lost the contest that the newest effect was added from.
struct Beaten {
  const Step& before;  ///< that it was added to
  std::string winner;
  const std::vector<Racer>& racers;  ///< the winner among them
};

/// The same over the steps of a search.
class LastContest {
 public:
  /// `winner` was added to the model of the step of this index.
  void won(std::string winner, size_t step, std::vector<Racer> racers);
  /// Other effects stand than the contest chose.
  void forget() { racers_.clear(); }
  /// Empty: the newest of `steps` does not have the winner, in whatever form, as the one thing
  /// more.
  std::optional<Beaten> beaten(const std::vector<Step>& steps) const;

 private:
  size_t step_ = 0;
  std::string winner_;
  std::vector<Racer> racers_;
};

/// Refits the leaders of a race and ranks them. Where nobody comes to the floor, the beaten run
/// too, with their winner from where they stood before it (race_beside); empty: there are none.
Result<Contest> refit_leaders(Workspace& workspace, const Step& step,
                              const std::optional<Beaten>& beaten, const DiscoverOptions& options,
                              const DiscoverEvents& events);

/// Why a refit does not stand beside the step that it started from.
struct Refusal {
  enum class Why {
    none,              ///< it stands
    may_be_nothing,    ///< its intervals hold its null, and without it the floor is reached
    does_not_pay,      ///< for its parameters
    held_out_against,  ///< held-out examples speak against it
    too_little,        ///< less than renderers and meshes err by
    more_is_there,     ///< it leaves most of what is over the floor
  };
  Why why = Why::none;
  std::string effect;
  Compared by = {};
  SourceLine where = SourceLine::current();  ///< of the rule
  explicit operator bool() const { return why != Why::none; }
  std::string words() const;  ///< "" where it stands
};
/// `before`: score of the step.
Refusal why_refused(const Step& step, double before, const Refit& with);
/// The same, both scored by what the refit leaves.
Refusal refused_by(const Step& step, Refit with);
/// Tells of it; whether it stands.
bool told_standing(const Decided& decided, const Refusal& refusal);

}  // namespace hookeye
