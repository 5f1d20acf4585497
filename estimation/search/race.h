// Effects against each other, a few steps of their refits in half-size pictures.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/trial.h"

namespace hookeye {

/// An effect after some steps of its refit.
struct Racer {
  std::string effect;
  ModelForm form;
  Trial trial;
  std::optional<Trial> next;  ///< after one step more: of the first four within reach
  TrialScale start{};         ///< the model without the effect, in the same pictures
  double chi() const { return trial.chi_fit + trial.chi_validate; }
  /// The part of it that is no noise, on fitted and on held-out photos; at least what
  /// FloorLimits::on times the floor is.
  double structured() const;
  /// Fitted and held-out photos within FloorLimits::at of it.
  bool at_floor() const;
  /// Left with SearchLimits::out_of_reach times the misfit of another after as many steps: nobody
  /// came from there to win, and the refit of a field costs as much as all others.
  bool out_of_reach_of(const Racer& other) const {
    return chi() > limits().out_of_reach * other.chi();
  }
  /// A tie needs equals: a rival that after as many steps is left with SearchLimits::may_tie times
  /// the misfit is none.
  bool may_tie_with(const Racer& other) const {
    return structured() < limits().may_tie * other.structured();
  }
  const SearchLimits& limits() const { return form.scene->limits->search; }
};

/// Of as much evidence as the effect of the largest: two steps from afar say less than the scores.
bool ties_with_first(const Diagnosis& diagnosis, const std::string& effect);

/// Named, physical, and of as much evidence as any such effect: nobody else may be called the
/// explanation before it has been fitted.
bool leads(const Diagnosis& diagnosis, const EffectScore& score);

/// What an effect left of the misfit, with chi of half-size photos after the steps of a race.
struct Raced {
  std::string effect;
  double chi_fit = 0.0, chi_validate = 0.0;
  double floor = 0.0;  ///< Trial::floor
};

/// One Gauss-Newton step with the effect from its linear step; of its two forms, where there are
/// two, the one that gets farther on fitted and held-out photos together in two: one step from afar
/// is luck where both fit.
Result<Racer> enter(Workspace& workspace, const Fitted& current, const EffectScore& score,
                    const TrialScale& scale, const FitOptions& options);

/// A racer that went on from `before` to `now` does not yet explain nearly all, and its next step
/// brings it there if that takes as large a part of what is left as the last one did. (Steps of a
/// fit that converges take more.) `start`: of the model without it.
bool brings_nearly_all(const Trial& before, const Trial& now, const TrialScale& start,
                       const SearchLimits& limits);

/// All nameable effects, each given one Gauss-Newton step from its linear step and the first four
/// another, where they are within reach, by falling success on fitted and held-out photos together.
/// The linear score knows a model's first step only: an effect that needs three (stiffening, a
/// clamp) loses there to a field that needs one. The first runs ahead: it takes its second step at
/// once, and more while they bring it to explain nearly all; then those that promise little do not
/// run. Effects without equilibrium on the way drop out. A finer mesh
/// runs as what it changes, to first order: only its refit is on that mesh.
Result<std::vector<Racer>> race(Workspace& workspace, const Fitted& current,
                                const Diagnosis& diagnosis, const FitOptions& options,
                                const std::function<void(const Racer&)>& tried = {});

/// Who lost a race from `before` to `won` and may be missing too: from where it got there, the
/// winner joins it from its null, for one step, and the first four for another. (A field that was
/// fitted to all has taken on what a clamp does: from there the clamp finds nothing to explain.)
/// `racers`: of that race. What moves no photo, the winner and numerical errors do not run.
Result<std::vector<Racer>> race_beside(Workspace& workspace, const Fitted& before,
                                       const EffectScore& won, const std::vector<Racer>& racers,
                                       const FitOptions& options,
                                       const std::function<void(const Racer&)>& tried = {});

}  // namespace hookeye
