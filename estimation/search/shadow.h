// The new score beside the old one: every refit of a search scored by score.h, and told. Internal
// to discover. Nothing here changes what the search decides or where its workspace stands.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/search/discover.h"
#include "estimation/search/score.h"

namespace hookeye {

class Shadow {
 public:
  explicit Shadow(Workspace& workspace, const FitOptions& options)
      : workspace_(workspace), options_(options) {}

  /// A step's model, diagnosed: refits are of what comes after it.
  void follow(const Step& step);
  /// Scores a refit once, by its own sums and by what a finer mesh would change there.
  void refitted(const Fitted& fitted);
  /// By how much its score is over that of the best model so far, all in the noise known now.
  /// Empty: it was not scored.
  std::optional<double> below_best(const Fitted& fitted) const;
  /// Tells every model that was scored since follow(), with the step's own and the best of the run,
  /// and how sure each is among all models of the run. `decided` may be empty.
  void tell_all(const Decided& decided) const;

 private:
  struct One {
    ScoredModel model;
    VectorXd p;
    double old = 0.0;  ///< refit_score less that of the step that it was refitted from
    bool of_this_step = true;
  };
  const One* find(const Fitted& fitted) const;
  void add(const Fitted& fitted, double old);
  /// Scores of all models in the order of models_, in the noise known now.
  const std::vector<ModelScore>& scores() const;

  Workspace& workspace_;
  const FitOptions& options_;
  std::optional<ModelPrices> prices_;
  std::shared_ptr<const Ingredient> mesh_;  ///< what a finer mesh changes; null: not known
  std::shared_ptr<const Scene> mesh_scene_;
  double to_the_limit_ = 1.0;
  std::optional<Fitted> step_;  ///< without pictures
  Floor floor_;
  std::vector<One> models_;
  mutable std::vector<ModelScore> scores_;  ///< of all models; empty: something has changed
};

}  // namespace hookeye
