// How the points of a measured field moved, and how the first guess says that they would.
#pragma once

#include <vector>

#include "estimation/inspection/inspection.h"
#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Of every field of example `e`, to first order. Empty: it has none, or there is no first guess.
std::vector<FieldMotion> field_motions(Sight& sight, int e);

/// Small strains of a field's points where the mesh's nodes move by u (3n), in its components.
VectorXd strains_to_first_order(const FieldSpec& field, const TetMesh& mesh, const VectorXd& u);
/// What the first guess of an example would show at a field's points: components point by point, to
/// first order and in equilibrium (empty: there is none).
struct ComparedField {
  VectorXd first_order, in_equilibrium;
};
std::vector<ComparedField> field_beside(Sight& sight, const MeasuredSpec& measured,
                                        const std::vector<int>& examples);

}  // namespace hookeye::inspection
