// Equilibrium of many examples at once, shared by simulate and render.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "estimation/model/model.h"
#include "simulation/equilibrium.h"

namespace hookeye {

/// The model of `file` on this scene, or the base model at its starting values where it is "".
Model realise_model(const std::string& file, const std::shared_ptr<const Scene>& scene);

/// Solves every example of the model, several at a time, with a progress bar. `done` gets each
/// state on the thread that found it, and may keep what it needs: the state itself, with its
/// factor, is dropped afterwards. (Where load cases are shared, it gets them one by one in the end,
/// without tangent and factor.) Returns the failure of each example that has no equilibrium.
std::vector<Result<void>> solve_examples(
    const Model& model, const std::string& title,
    const std::function<void(int example, const Equilibrium& state)>& done);

/// Throws Failed (or Interrupted) for the first failure, if there is one.
void fail_on_first(std::vector<Result<void>>& failures);

}  // namespace hookeye
