// The loop of the product: fit, diagnose, add, until what is left is noise.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "estimation/diagnosis.h"
#include "estimation/fit.h"
#include "estimation/refit.h"
#include "estimation/verdict.h"

namespace hookeye {

/// What refits are scored by, the same for all that are compared.
struct Yardstick {
  const Fitted* reference;  ///< whose residuals' correlation counts
  const Floor* floor;
  /// Variance of forces, moments and positions in units of what was told of them: the least that
  /// any of the compared leaves. A renderer's errors in the photos are none of it.
  double measured_noise2;
};

/// chi of fitted and of held-out photos together.
double misfit(const Fitted& fitted);

/// Mean square of what `fitted` leaves of forces, moments and positions, 1 (as told) at least.
double measured_noise2(const Fitted& fitted);

/// log-likelihood of a fitted model with the effective number of residuals: fitted and held-out
/// photos, each with a variance of their own, and measurements; minus (dof/2) log N (BIC). (While
/// something large is missing, held-out photos may miss by three times as much: of one variance for
/// all they alone would choose, by how a wrong model happens to extrapolate.) N is of the values
/// that show a parameter: for an error of the sensors, which no photo shows, the measured ones
/// alone.
double refit_score(const Fitted& fitted, const Yardstick& yardstick);

/// Whether the held-out examples speak against `with`: by their log-likelihood, less than a tie
/// (kTie) is no word. Nor is a rise of the photos' chi^2 by no more than `least`, which meshes and
/// renderers err by (least_fall): once all else is white, likelihood tells hundredths of a pixel,
/// and an effect that took away nine tenths of the fitted misfit was refused for them. An effect
/// that no held-out example can show, like a contact in one load case, is judged by the fitted
/// ones.
bool held_out_allows(const Fitted& with, const Fitted& without, const Floor& floor,
                     double least = 0.0);

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
  double measured_r2 = 0.0;  ///< of forces, moments and positions, in told deviations
};

struct DiscoverOptions {
  FitOptions fit;
  DiagnosisOptions diagnosis;
  int leaders = 3;  ///< effects refitted to the end at each step
  int max_effects = 4;
  /// Of the steps up to the one that discover_from() starts at, that one with them.
  std::vector<std::string> tie;
  std::vector<Contested> past;
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
};

/// Names of what stands in `form` beyond the capture's own model, in order; each
/// once (Effect::several).
std::vector<std::string> effects_in(const ModelForm& form);

Contested contested(const Step& step);

/// What the named effects took over the steps of a run, one after the other.
TakenByNames taken_by_names(const std::vector<Contested>& steps, const Floor& floor);

struct Discovery {
  std::vector<Step> steps;
  Verdict verdict = Verdict::unexplained;
  std::string sentence;              ///< one line: what was missing, how sure, what else
  std::vector<std::string> missing;  ///< effects in the last step's model, as they were added
  std::vector<std::string> tie;      ///< effects that could not be told apart
  /// Where the held-out photos are missed by values alone: not a step, as they stay held out.
  std::optional<FitToAll> all;
  Floor floor;
};

/// Called with every finished step and refit; what is printed and written is the caller's matter.
struct DiscoverEvents {
  std::function<void(const Step&)> step;
  std::function<void(const Racer&)> tried;
  std::function<void(const std::string& effect)> refitting;
  std::function<void(const std::string& effect, const std::variant<Fitted, NumericalFailure>&)>
      refitted;
};

std::variant<Discovery, NumericalFailure> discover(Workspace& workspace, const ModelForm& form,
                                                   const VectorXd& start,
                                                   const DiscoverOptions& options,
                                                   const DiscoverEvents& events = {});

/// Continues a run from its last step's model.
std::variant<Discovery, NumericalFailure> discover_from(Workspace& workspace, Step first,
                                                        const DiscoverOptions& options,
                                                        const DiscoverEvents& events = {});

}  // namespace hookeye
