// What a run has come to, in a word and in a sentence.
#pragma once

#include <string>
#include <vector>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/fit.h"

namespace hookeye {

/// What is left is noise (explained); so it would be with another effect in the place of one
/// (ambiguous: a tie); it is not, tie or none (unexplained).
enum class Verdict { explained, unexplained, ambiguous };
const char* to_string(Verdict verdict);

/// The model with all examples fitted, where that leaves fitted and held-out photos at the floor
/// though the values of the fitted ones alone miss the held-out ones (fit_to_all.h).
struct FitToAll {
  Fitted fitted;                             ///< in a scene that holds nothing out
  double chi_fit = 0.0, chi_validate = 0.0;  ///< by what the capture uses the examples for
  /// "creep.tau 1.5 (here 2.31, 0.849 .. 6.98)": the values that the fitted examples know least.
  std::vector<std::string> hardly_known;
};

/// What the diagnosis of the newest model says about the run. `all`: null where there is none.
Verdict judge(const Fitted& fitted, const Diagnosis& diagnosis, const std::vector<std::string>& tie,
              std::string* why, const FitToAll* all = nullptr);

/// Falls over the steps that added a named effect: of what chi^2 of fitted and of held-out photos
/// has over the floor's, and of the sum of squares of forces, moments and positions.
struct TakenByNames {
  double fit = 0.0, held_out = 0.0, measured = 0.0;
};

/// Of photos near the floor all along a small effect may be part of what has no name: what stays
/// over the floor is more than renderers leave at least (FloorLimits::on) and than the named took,
/// for which no sensor speaks. Where they change brightness alone it is over the told noise: the
/// floor is of that kind, a gloss without a name is in it. Said in words; "": it is not so.
std::string more_stays(const Fitted& fitted, const Diagnosis& diagnosis, const TakenByNames& taken);

/// Rest photos in which the body is as it was given show it moved all the same, smoothly, by more
/// than renderers err by (renderers_err_by, and all that they leave over the noise) and by a tenth
/// of what is over the floor, where more than FloorLimits::on times the floor is left: no mesh and
/// no law moves a body without a load, so what stays is not theirs alone. Said in words; "": it is
/// not so.
std::string moved_at_rest(const Fitted& fitted, const Diagnosis& diagnosis);

/// The photos are explained but for what a finer mesh would change. That is told beside the
/// parameters, whose intervals reach there (reach_for_mesh); a fit on that mesh would cost several
/// times all that was fitted before, and name nothing.
bool only_numerical_left(const Fitted& fitted, const Diagnosis& diagnosis,
                         const FitToAll* all = nullptr);

/// What each effect of the model is at its fitted values, in the order in which they were added:
/// "gravity: self-weight, 9.8 m/s2 towards (0.15, 0.09, -0.98)".
std::vector<std::string> effects_in_words(const Fitted& fitted);

/// The effect that leads by its evidence and is not named because it takes away less than renderers
/// and meshes err by (nameable), where it would take most of what held-out photos have over the
/// floor: its values are not fitted to those. A hint in words; "": none.
std::string too_little_to_name(const Diagnosis& diagnosis, const std::string& seen = "photos");

/// Effects that stand out by more than chance (Diagnosis::gate), would take a share that is worth a
/// name (SearchLimits::worth_a_name), and have not the evidence to be named: the photos hold too
/// few independent residuals to tell. By falling evidence.
std::vector<std::string> cannot_be_told(const Diagnosis& diagnosis);
/// "stiffness_field, pressure, creep or 4 other effects".
std::string any_of_them(const std::vector<std::string>& effects);

/// One line: what was missing, how sure, what else. `why` is judge()'s, `refused` why the effect
/// that came farthest was not added ("": none was refused), `untold` cannot_be_told()'s,
/// `seen` seen_in_words().
std::string say(Verdict verdict, const std::vector<std::string>& missing,
                const std::vector<std::string>& tie, std::string why, const std::string& refused,
                const std::vector<std::string>& untold = {}, const std::string& seen = "photos");

}  // namespace hookeye
