// The true model of a recipe and its equilibria. Internal to synth.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "core/numerical_failure.h"
#include "estimation/model/effect.h"
#include "estimation/synth/recipe.h"
#include "estimation/synth/synth_capture.h"
#include "simulation/equilibrium.h"

namespace hookeye::detail {

/// Equilibria of all examples of one scene, warm-started.
class TruthSolver {
 public:
  TruthSolver(std::shared_ptr<const Scene> scene, const std::atomic<bool>* cancel);
  struct State {
    VectorXd q;
    GripForce grip;  ///< on the example's moved region, zero where there is none
  };
  Result<std::vector<State>> solve(const Model& model);

 private:
  std::shared_ptr<const Scene> scene_;
  const std::atomic<bool>* cancel_;
  std::vector<EquilibriumSolver> solvers_;
};

/// An effect as it was put in.
struct PutIn {
  const Effect* effect;
  std::shared_ptr<const Ingredient> ingredient;
  VectorXd values;
  double rms_px = 0.0;  ///< fitted examples
  std::string sentence;
};

struct Truth {
  ModelForm form;
  VectorXd p;
  Model model;
  std::vector<TruthSolver::State> states;
  std::vector<PutIn> hidden;
  int elements_lost = 0;  ///< without ellipticity, over all examples (lost_ellipticity.h)
};

/// Puts the recipe's hidden effects in, one after another, scaling those with rms_px.
Result<Truth> find_truth(const Recipe& recipe, std::shared_ptr<const Scene> scene,
                         const std::atomic<bool>* cancel);

}  // namespace hookeye::detail
