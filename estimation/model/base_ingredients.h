// Ingredients of the base model: what a capture tells or leaves to be fitted.
#pragma once

#include <memory>
#include <vector>

#include "estimation/model/model.h"

namespace hookeye {

/// What `fit:` names, over all materials: one ingredient; with `fit: [additive]`, where all
/// materials are, one for each, which stays convex. Empty when nothing moves. Throws InputError for
/// an unknown name.
std::vector<std::shared_ptr<const Ingredient>> material_ingredients(const Scene& scene,
                                                                    const EnergyModel& energy);
/// Six numbers for every `rigid: fit` support; null when there is none.
std::shared_ptr<const Ingredient> rigid_support_ingredient(const Scene& scene);
/// Ambient and sun (vector), or the sky's harmonics where they are asked for, common to all photos;
/// light was not told.
std::shared_ptr<const Ingredient> light_ingredient(const Scene& scene);
/// Of each camera what is asked for: vignetting, and the sizes of the red and the blue picture.
/// Null: nothing is.
std::shared_ptr<const Ingredient> lens_ingredient(const Scene& scene);
/// One uniform albedo.
std::shared_ptr<const Ingredient> albedo_ingredient();
/// One background level a camera, of its photos with `background: fit`. Null: there are none.
std::shared_ptr<const Ingredient> background_ingredient(const Scene& scene);
/// Rigid pose of the whole set-up: rotation vector about the body's centroid and a translation.
std::shared_ptr<const Ingredient> placement_ingredient(const Scene& scene);
/// Told self-weight (no parameters), in the world.
std::shared_ptr<const Ingredient> self_weight_ingredient(const Vector3d& gravity_in_world);

/// Moves the set-up by a motion told in the body's frame (cameras and light see the body moved):
/// placement' = placement * motion. Self-weight already in the model turns against the body.
void place(Model& model, const Eigen::Isometry3d& motion);
/// Pose from a rotation vector [rad] about `centre` and a translation.
Eigen::Isometry3d pose_about(const Vector3d& centre, const Vector3d& rotation,
                             const Vector3d& translation);

/// Density of the body; the effect of gravity is the product density * g, so that a density of 1
/// stands in where none is told.
double density_or_one(const Capture& capture);

}  // namespace hookeye
