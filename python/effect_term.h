// Energies and forces of effects written in Python.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "meshing/regions.h"
#include "python/bridge.h"
#include "simulation/batch_term.h"
#include "simulation/loading.h"

namespace hookeye {

/// What an energy is a function of.
enum class EnergyOf { gradient, invariants };

/// The energy of an effect at the values of its parameters.
std::shared_ptr<const EnergyTerm> python_energy(std::shared_ptr<const Bridge> bridge, EnergyOf of,
                                                Eigen::VectorXd values);

/// Where a force acts: points of cells (elements, or faces of the boundary), cell by cell.
struct LoadPoints {
  int per_cell = 0;
  int mesh_nodes = 0;
  Matrix3Xd X;             ///< at rest
  Matrix3Xd normal;        ///< outwards at rest, unit; of a body: without columns
  Eigen::VectorXd weight;  ///< rest volume or area that a point stands for
  Eigen::MatrixXi nodes;   ///< a column a cell
  Eigen::MatrixXd shape;   ///< nodes of a cell x per_cell
  /// Where deformed positions q (3n) put them.
  Matrix3Xd at(const Eigen::VectorXd& q) const;
};
LoadPoints volume_points(const TetMesh& mesh);
LoadPoints surface_points(const TetMesh& mesh, const Region& region);

/// `share` times the force of an effect. `follows`: it depends on where the body is.
std::shared_ptr<const ForceTerm> python_force(std::shared_ptr<const Bridge> bridge,
                                              std::shared_ptr<const LoadPoints> points,
                                              bool follows, double share, Eigen::VectorXd values);

}  // namespace hookeye
