// Forms of stiffness_field that its refit goes on to: stiffness that changes along a direction.
#pragma once

#include "estimation/effects/toolbox.h"

namespace hookeye {

/// Multiplies the weights of all parts by exp(log_factor), one value an element.
void scale_energy(Model& model, const VectorXd& log_factor);

bool is_graded(const std::string& variant);
/// "free gradient": log of the stiffness u + bend u^2, u = g.(X - centre) / size; the bend tells a
/// stiffness that is linear (-1/2) from one whose logarithm is (0).
/// "free layers across N": exp(a) times as stiff beyond a plane, of free normal around N, free
/// place and free thickness; elements that it cuts take their mean over it. Null: another variant.
std::shared_ptr<const Ingredient> graded_form(const Model& model, const std::string& variant);
/// Both, where they are most like a log of the stiffness told element by element.
std::vector<Effect::Further> further_grades(const Model& model, const VectorXd& log_factor);
std::string graded_sentence(const Model& model, const Ingredient& ingredient,
                            const VectorXd& values);

}  // namespace hookeye
