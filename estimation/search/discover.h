// The loop of the product: fit, diagnose, add, until what is left is noise.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/fit/fit.h"
#include "estimation/search/refit.h"
#include "estimation/search/verdict.h"

namespace hookeye {

/// A leader of the race, refitted to the end.
struct Rival {
  std::string effect;
  double score = 0.0;  ///< refit_score minus the winner's
  double chi_fit = 0.0, chi_validate = 0.0;
};

/// Who won a contest, what left the model for it, who stood in it and what the step's model leaves.
struct Contested {
  std::string added;
  std::vector<std::string> dropped;
  std::vector<Rival> rivals;
  double chi_fit = 0.0, chi_validate = 0.0;
  double measured_r2 = 0.0;               ///< of forces, moments and positions, in told deviations
  std::vector<std::string> not_compared;  ///< Step::not_compared
};

struct DiscoverOptions {
  FitOptions fit;
  DiagnosisOptions diagnosis;
  std::optional<int> max_effects;  ///< empty: SearchLimits
  /// Of the steps up to the one that discover_from() starts at, that one with them.
  std::vector<std::string> tie;
  std::vector<Contested> past;
  /// Every refit is scored beside (shadow.h); decides nothing.
  bool scored = true;
};

/// One step of a run.
struct Step {
  std::string name;   ///< "base" or the added effect
  std::string added;  ///< "" for the base
  /// Effects of earlier steps that the added one made idle: not in this step's model any more.
  std::vector<std::string> dropped;
  Fitted fitted;
  Diagnosis diagnosis;        ///< of this step's model
  std::vector<Raced> raced;   ///< all that the added effect was chosen from, best first
  std::vector<Rival> rivals;  ///< those of them that were refitted, the added one among them
  /// Who stood out as much as any when the effect was added, and could not be fitted.
  std::vector<std::string> not_compared;
};

/// Names of what stands in `form` beyond the capture's own model, in order; each
/// once (Effect::several).
std::vector<std::string> effects_in(const ModelForm& form);

Contested contested(const Step& step);

/// "; not compared: ...": who stood out as much as what was added, could not be fitted in any form,
/// and is not in the model. "": nobody.
std::string not_compared(const std::vector<Contested>& steps,
                         const std::vector<std::string>& missing);

/// What the named effects took over the steps of a run, one after the other.
TakenByNames taken_by_names(const std::vector<Contested>& steps, const Floor& floor);

struct Discovery {
  std::vector<Step> steps;
  Verdict verdict = Verdict::unexplained;
  std::string sentence;              ///< one line: what was missing, how sure, what else
  std::vector<std::string> missing;  ///< effects in the last step's model, as they were added
  std::vector<std::string> tie;      ///< effects that could not be told apart
  std::vector<std::string> untold;   ///< cannot_be_told(), where the verdict is unexplained
  /// Where the held-out photos are missed by values alone: not a step, as they stay held out.
  std::optional<FitToAll> all;
  Floor floor;
};

/// Called with every finished step and refit; what is printed and written is the caller's matter.
struct DiscoverEvents {
  std::function<void(const Step&)> step;
  std::function<void(const Racer&)> tried;
  std::function<void(const std::string& effect)> refitting;
  std::function<void(const std::string& effect, const Result<Fitted>&)> refitted;
};

Result<Discovery> discover(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                           const DiscoverOptions& options, const DiscoverEvents& events = {});

/// Continues a run from its last step's model.
Result<Discovery> discover_from(Workspace& workspace, Step first, const DiscoverOptions& options,
                                const DiscoverEvents& events = {});

}  // namespace hookeye
