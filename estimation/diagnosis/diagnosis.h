// Which effect is missing: every effect of the catalogue tested against the residual without
// refitting (method.md, "Which effect is missing").
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "estimation/diagnosis/adequacy.h"
#include "estimation/fit/fit.h"
#include "estimation/fit/floor.h"
#include "estimation/model/effect.h"

namespace hookeye {

struct Confusion {
  std::string effect;
  double cosine;  ///< share (as a cosine) of the signature that the other effect can imitate
};

struct EffectScore {
  std::string effect;
  bool testable = true;
  std::string why_not;  ///< not applicable, already in the model, or untestable, and why
  std::shared_ptr<const Ingredient> best;  ///< best candidate
  VectorXd values;                         ///< its parameters after one linear step from the null
  VectorXd base_step;                      ///< what the fitted parameters would do at the same time
  VectorXd standard_error;                 ///< of values, correlated residuals counted
  int dof = 0;
  double explains = 0.0;           ///< predicted share of (chi^2 - floor^2) removed, fitted photos
  double explains_held_out = 0.0;  ///< the same step on the held-out photos
  double fall = 0.0;               ///< predicted fall of chi^2 on the fitted photos
  double fall_held_out = 0.0;      ///< the same step on the held-out photos
  /// Predicted fall of the sum of squares of fitted forces, moments and positions over told noise.
  double measured_fall = 0.0;
  /// As much of `fall` could be the mesh's own error: Diagnosis::mesh_fall, or, of an effect on
  /// brightness alone, what it could imitate of that.
  double mesh_fall = 0.0;
  double evidence = 0.0;  ///< log marginal likelihood over the current model
  double bic = 0.0;       ///< of the best candidate: gain less 1/2 dof log N
  double p_value = 1.0;   ///< of the largest evidence in the catalogue under the simulated null
  double weight = 0.0;    ///< evidence among the tested effects, summing to one
  std::vector<Confusion> confused_with;
  /// Where the linear step takes the examples (3n each): of the leading effects and of all with
  /// evidence enough to be named.
  std::map<int, VectorXd> displaced;
  bool pictured = false;  ///< one of the DiagnosisLimits::pictured leading effects
  std::string why;        ///< one plain sentence
  /// Another form of the effect that explains more of the held-out photos, though the fitted ones
  /// speak for `best` (one load turned instead of all), or one that they cannot tell from it (creep
  /// with the logarithm of the order, and steadily with it): a trial decides. Null: there is none.
  std::shared_ptr<const EffectScore> other_form;
};

struct Diagnosis {
  std::vector<EffectScore> effects;  ///< by falling evidence; untestable ones last
  double gate = 0.0;                 ///< 95 % point of the largest evidence when nothing is missing
  double effective_count = 0.0;
  double whiteness_p = 1.0;  ///< smallest photo p-value, Bonferroni
  Floor floor;
  std::vector<MotionLeft> motions;  ///< that photos keep, fitted and held out
  const DiagnosisLimits& limits() const { return floor.limits->diagnosis; }
  /// Change of the fitted parameters that an ever finer mesh would bring, to first order: what the
  /// next refinement brings, extrapolated (Richardson: the error falls with the square of the edge,
  /// quadratic elements beside clamps and corners, and to a tenth from linear to quadratic ones);
  /// where the mesh has been refined, less the share that the model has. Empty: not known (the mesh
  /// cannot be made finer).
  VectorXd mesh_shift;
  std::string mesh_note;  ///< those that move beyond their intervals for noise; empty: none
  /// Mean square of what the same would change in fitted forces, moments and positions, over their
  /// told noise: so much of a misfit is the mesh's.
  double mesh_in_measured = 0.0;
  /// Fitted photos are at the floor, held-out ones are not: those alone show what is missing.
  bool held_out_missed = false;
  bool held_out_over = false;  ///< held-out photos are not at the floor, whatever the fitted are
  /// Change of chi^2 by what the next finer mesh would do to a model whose mesh has been refined:
  /// by Richardson's rule, second order, 0.7^2 of what the refinement did. 0: not refined.
  double mesh_fall = 0.0;
  double mesh_fall_held_out = 0.0;  ///< of the held-out photos' chi^2, the fitted values following
};

struct DiagnosisOptions {
  std::optional<int> null_simulations;  ///< empty: DiagnosisLimits
  unsigned seed = 1;
  /// Names to leave out (leave-one-out benchmarks).
  std::vector<std::string> without;
  /// Tested beside the catalogue (placebos).
  std::vector<const Effect*> also;
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(int done, int of)> progress;  ///< as EvaluationOptions has it
};

Result<Diagnosis> diagnose(Workspace& workspace, const Fitted& fitted,
                           const DiagnosisOptions& options = {});

/// One that was read, or that an archive had (Workspace::keep_in), has no EffectScore::displaced:
/// what removed.h draws of it would be missing.
bool lacks_displaced(const Diagnosis& diagnosis);
/// Works that out anew. Empty: done.
Result<void> displace_again(Workspace& workspace, const Fitted& fitted,
                            const std::atomic<bool>* cancel, Diagnosis& diagnosis);

/// Extends the intervals, which know of noise alone, to where an ever finer mesh would take the
/// values: mesh_shift.
void reach_for_mesh(Fitted& fitted, const Diagnosis& diagnosis);

/// Fall of chi^2 below which an effect is not named although noise alone would not give it:
/// renderers_err_by (floor.h), or what is smaller than the mesh's own error. Of the fitted photos,
/// or of the held-out ones.
double least_fall(const Diagnosis& diagnosis, const std::string& effect, bool held_out = false);
/// The effect stands for errors of the computation.
bool numerical(const std::string& effect);
/// `fall` of the sum of squares of measured values over told noise is DiagnosisLimits::nameable in
/// log-likelihood, noise being what is told and what an ever finer mesh would change: no renderer
/// errs in a force.
bool sensors_speak(double fall, const Diagnosis& diagnosis);
/// It changes what sensors show and nothing in the photos.
bool sensors_alone(const Ingredient& ingredient);
/// It changes how bright or sharp photos are, and nothing of where they show the body.
bool brightness_alone(const Ingredient& ingredient);
/// What fitted data make of the effect takes more than half of what held-out photos have over the
/// floor, which had no part in its values: those alone show that something is missing, or it has
/// evidence enough to be named and takes more there than renderers and the mesh err by there. (On a
/// mesh that was coarse that may be more than a small effect takes of the fitted photos, which
/// values wronged by it have made up for.)
bool held_out_say_so(const EffectScore& score, const Diagnosis& diagnosis);
/// Testable, above the simulated gate, and, where it is seen in photos alone, above the renderer's
/// and the mesh's own errors; or sensors speak for it (sensors_speak; of the mesh they have
/// mesh_in_measured). (The mesh's own effect is not held to the mesh's error: it is not offered
/// then.) Or held-out photos say so, and it is above the gate.
bool nameable(const EffectScore& score, const Diagnosis& diagnosis);
/// The leader of those that can be named with all that tie with it: by less than
/// DiagnosisLimits::tie in evidence, or because the information criterion puts them before it
/// (method.md, 3 and 5). Without the mesh's own error beside others. Empty: nothing can be named.
std::vector<std::string> leaders(const Diagnosis& diagnosis);
/// For every effect, whether it is named and by which number.
std::vector<Decision> naming_decisions(const Diagnosis& diagnosis);
/// One sentence: what leads, what ties with it and what would tell them apart, or that nothing
/// stands out.
std::string conclusion(const Diagnosis& diagnosis);

}  // namespace hookeye
