// What each load case would do to the body at the told values: one coarse solve each.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "estimation/inspection/options.h"
#include "estimation/model/model.h"
#include "simulation/equilibrium.h"

namespace hookeye::inspection {

struct FirstGuess {
  /// To first order from rest: displacement of the render surface's vertices, 3 x nv [length]. Zero
  /// where nothing moves the body; empty where nothing holds it.
  Matrix3Xd linear;
  VectorXd u;         ///< the same of the coarse mesh's nodes, 3n (empty: not asked for)
  VectorXd reaction;  ///< what supports exert on the body there, 3n; zero on free unknowns [force]
  double strain = 0.0;  ///< largest of an element, to first order: |sym grad u|
  /// A support turns by more than 30 degrees: nothing is right to first order.
  bool turned = false;
  /// In equilibrium: positions of the vertices; empty: none was found, or sought.
  Matrix3Xd x;
  VectorXd q, R;        ///< positions and reactions of the coarse mesh's nodes there, 3n each
  std::string failure;  ///< why x is empty
};

/// The told model on a coarse mesh. Linear tetrahedra on the told mesh's corners, or on a coarser
/// one where those are too many: they are too stiff by up to a half, which neither directions nor
/// orders of magnitude mind. With less than two of them across a thin body they lock: one layer
/// bends a hundred times too little. Then quadratic ones, as few nodes of them.
class CoarseModel {
 public:
  CoarseModel(const Scene& scene, const InspectionOptions& options);
  /// On the mesh of `scene` itself.
  CoarseModel(std::shared_ptr<const Scene> scene, const InspectionOptions& options);
  ~CoarseModel();
  const std::string& refused() const { return refused_; }  ///< why there is none; "": there is
  const Scene& scene() const { return *scene_; }
  const Model& model() const { return model_; }

  /// First guesses of all examples, in equilibrium where it can be had. Of those that are not in
  /// `nodes` what the nodes do is left out: of a thousand load cases it is more than their photos.
  /// `solved` (may be empty, any thread): load cases in equilibrium that are done, of all.
  std::vector<FirstGuess> solve(const std::set<int>& nodes,
                                const std::function<void(int done, int of)>& solved) const;
  /// The first-order answer of example `e` to another loading than the told one.
  FirstGuess answer(int e, const Loading& loading) const;

 private:
  /// The body at rest, held as a load case holds it: `why`, where that has no equilibrium.
  struct AtRest {
    std::shared_ptr<const Equilibrium> state;
    std::shared_ptr<std::mutex> one_at_a_time;  ///< its factor has memory of its own
    std::string why;
  };
  static constexpr size_t kMostKept = 8;
  /// By what is held and by how stiff an example is: load cases share it.
  using Held = std::pair<std::vector<int>, double>;

  Held held(int e, const Loading& loading) const;
  AtRest at_rest(int e, const Loading& loading) const;
  void keep_at_rest() const;
  FirstGuess to_first_order(int e, const Loading& loading) const;
  bool needs_equilibrium(FirstGuess* guess) const;
  void find_equilibria(std::span<const size_t> examples, const std::function<void()>& done,
                       std::vector<FirstGuess>* guesses) const;

  InspectionOptions options_;
  std::string refused_;
  std::shared_ptr<const Scene> scene_;
  Model model_;
  std::unique_ptr<EquilibriumSolver> of_mesh_;  ///< keeps what all solvers of the mesh share
  mutable std::mutex mutex_;
  mutable std::map<Held, AtRest> known_;  ///< at most kMostKept: each is as large as a factor
};

}  // namespace hookeye::inspection
