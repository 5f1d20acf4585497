// hookeye.Equilibrium and what a model shows: equilibria, pictures, normal equations.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include "python/model.h"
#include "python/work.h"
#include "runs/look.h"

namespace hookeye {

/// One load case solved, with all that reads it.
struct SolvedExample {
  Model model;
  int example = 0;
  Equilibrium state;
  const TetMesh& mesh() const { return model.scene->body->mesh; }
};

/// For the thread of the work. Throw InputError, Failed or Interrupted.
std::shared_ptr<SolvedExample> simulate(const ModelState& model, const std::string& example,
                                        const Work& work);
Sighting render(const ModelState& model, const std::string& example, const std::string& camera,
                const Work& work);
Evaluation evaluate(Workspace& workspace, const ModelState& model, bool derivatives, bool held_out,
                    const Work& work);

/// A model at one deformed state, in equilibrium or not.
struct Probed {
  VectorXd energy;          ///< of each example
  Eigen::MatrixXd forces;   ///< 3n x examples: what is out of balance
  Eigen::MatrixXd tangent;  ///< the same: its derivative along a direction
  VectorXd numbers;         ///< prescribed motion, photos and measurements
};
/// `q`: 3n positions; `along`: 3n. Throws InputError for another size.
Probed probe(const ModelState& model, const VectorXd& q, const VectorXd& along);

void bind_equilibrium(pybind11::module_& m);

}  // namespace hookeye
