// A small block under a few loads, seen by two cameras: what the catalogue is tried on.
#pragma once

#include <memory>

#include "estimation/model/effect.h"

namespace hookeye::test {

/// Block 20 x 16 x 40 mm, clamped at its base: rest, pull, twist (rigid, measured force), bend, and
/// press held out. Photos are grey: they fix the sizes, not the contents. Read once.
std::shared_ptr<const Scene> block_scene();
/// The same block made of an additive material with anisotropy and couplings; `fit` is left open.
std::shared_ptr<const Scene> additive_block(std::vector<std::string> fit);
/// The same set-up (mesh, regions, loads, told motions) turned by 90 degrees about z.
std::shared_ptr<const Scene> turned_scene();
/// x -> (-y, x, z), exact.
Eigen::Vector3d quarter_turn(const Eigen::Vector3d& x);

/// The same state for any scene of this body: stretched, bent and twisted, nothing symmetric.
VectorXd deformed_state(const Scene& scene);

/// Everything that a realised model is, as one vector: residuals of all examples at a fixed state,
/// told motions, photo numbers, sensor offsets, placement.
VectorXd signature(const Model& model, const VectorXd& q);

/// The model with the equilibria of its fitted examples, as a diagnosis shows it to the catalogue.
Model with_states(Model model);

/// The base model of block_scene() at its start, with those states.
const ModelForm& base();
const Model& base_model();

/// Base model of the scene with one more ingredient at the end.
ModelForm extended(const ModelForm& base, std::shared_ptr<const Ingredient> ingredient);
/// Values of `form`: base at its start, the last ingredient at `values`.
VectorXd with_values(const ModelForm& form, const VectorXd& values);
VectorXd null_values(const Ingredient& ingredient);
/// A size at which the ingredient matters, inside its bounds.
VectorXd some_values(const Ingredient& ingredient);

}  // namespace hookeye::test
