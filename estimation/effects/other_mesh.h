// What another mesh of the same body makes of a model.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "estimation/model/model.h"
#include "simulation/equilibrium.h"

namespace hookeye {

/// A body on another mesh, with what serves the next model too.
struct OtherBody;

/// What another mesh of the same body makes of the present model, as nodal forces on this one:
/// f = K du moves this mesh by du, to where the other mesh has the body (first order), and
/// changes the reactions of the supports by as much. Solved once an example, when first asked for:
/// by the model alone, whoever asks and whatever was solved before. One example at a time: a factor
/// of the other mesh is larger than all else.
class OtherMesh {
 public:
  /// `factor`, `order`: as remeshed().
  OtherMesh(const Model& model, double factor, int order);

  /// 3n [force]; zero where there is no such mesh or no equilibrium, so that the effect cannot be
  /// tested. Any thread.
  const VectorXd& force(int example);

 private:
  struct Slot {
    std::once_flag once;
    VectorXd force;
  };
  VectorXd compute(int example);
  Result<Equilibrium> solve_here(int example) const;
  Result<Equilibrium> solve_there(int example, const Equilibrium& here);
  void realise_there();
  void drop_idle_solver(int example);
  void add_reaction(const std::string& region, const Equilibrium& here, const Equilibrium& there,
                    VectorXd& reaction) const;

  const Model model_;
  const double factor_;
  const int order_;
  std::once_flag once_;
  std::shared_ptr<OtherBody> body_;
  Model other_;
  std::vector<Slot> forces_;
  std::vector<bool> done_;  ///< by example
  bool asked_held_out_ = false;
};

}  // namespace hookeye
