// How the points of a measured field moved, and how the first guess says that they would.
#pragma once

#include <vector>

#include "estimation/inspection/inspection.h"
#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Of every field of example `e`, to first order. Empty: it has none, or there is no first guess.
std::vector<FieldMotion> field_motions(Sight& sight, int e);

/// How the coarse mesh's nodes go in the first guess from one example (-1: from the body as it was
/// given) to another, 3n each; empty: there is no guess.
struct GuessedMotion {
  VectorXd first_order, in_equilibrium;
};
GuessedMotion guessed_motion(Sight& sight, int start, int e);

/// The coarse mesh where a field's points lie on it: as it was given, or as the first guess deforms
/// it in the load case that the field starts from. What that is off, moduli decide: then the body
/// as it was given may be nearer, and stands for it.
TetMesh mesh_of_field(Sight& sight, const MeasuredSpec& measured);

/// Small strains of a field's points where the nodes of `mesh`, on which they lie, move by u (3n),
/// in its components. Empty: the field starts from a load case whose guess has its axes out of the
/// surface.
VectorXd strains_to_first_order(const MeasuredSpec& measured, const TetMesh& mesh,
                                const VectorXd& u);
/// What the first guess of examples would show at a field's points, each from where `starts` tells:
/// components point by point, to first order and in equilibrium (empty: there is none, or it is of
/// strains).
std::vector<GuessedMotion> field_beside(Sight& sight, const MeasuredSpec& measured,
                                        const std::vector<int>& examples,
                                        const std::vector<int>& starts);

}  // namespace hookeye::inspection
