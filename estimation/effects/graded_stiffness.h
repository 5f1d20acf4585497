// Forms of stiffness_field that its refit goes on to: stiffness that changes along a direction, or
// jumps at a plane or at the edge of a ball.
#pragma once

#include "estimation/effects/toolbox.h"

namespace hookeye {

/// Multiplies the weights of all parts by exp(log_factor), one value an element.
void scale_energy(Model& model, const VectorXd& log_factor);

bool is_graded(const std::string& variant);
/// "free gradient": log of the stiffness u + bend u^2, u = g.(X - centre) / size; the bend tells a
/// stiffness that is linear (-1/2) from one whose logarithm is (0).
/// "free layers across N": exp(a) times as stiff beyond a plane, of free normal around N, free
/// place and free thickness; elements that it cuts take their mean over it. "free ball": the same
/// within a ball, as an inclusion is. Null: another variant.
std::shared_ptr<const Ingredient> graded_form(const Model& model, const std::string& variant);
/// Gradient and layers, where they are most like a log of the stiffness told element by element.
std::vector<NextForm> further_grades(const Model& model, const VectorXd& log_factor);
/// Two layers parted through the body's middle: exp(a) times as stiff beyond as before.
NextForm layers_like(const Model& model, const Vector3d& across, double a);
/// The ball, where it is most like a Gaussian of these values (free_place): of one integral over
/// the body of its logarithm and of that squared.
NextForm ball_like(const Model& model, const VectorXd& blob, int place = 1);
/// a, x, y, z, radius: one place of free amplitude in the log of the stiffness.
std::vector<Parameter> free_place(const Model& model);
/// Over which a ball's edge is smeared: thinner is a jump to every mesh, thicker than the body a
/// gradient.
Parameter edge_thickness(const Model& model);
/// Log of the stiffness, element by element, within a ball; values a, its centre, radius,
/// thickness.
VectorXd ball_field(const Scene& scene, const VectorXd& values);
std::string graded_sentence(const Model& model, const Ingredient& ingredient,
                            const VectorXd& values);

}  // namespace hookeye
