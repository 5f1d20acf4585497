// Forms of anisotropy beside fibres that pull and push alike: those that only pull; then
// stiffnesses of their own.
#pragma once

#include "estimation/effects/stiffness_forms.h"

namespace hookeye {

/// As scored: W += k/2 (I4 - 1)^2 in tension, isochoric, 0 in compression, along `a`.
std::shared_ptr<const Ingredient> pulling_along(const Model& model, const Vector3d& a);
/// Its refit, pulling_around(); empty: `scored` is none.
std::vector<NextForm> refit_of_pulling(const Model& model, const Ingredient& scored,
                                       const VectorXd& values);
/// W += k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1) in tension, 0 in compression, the fibre's direction free
/// around `a`; I4 isochoric or with the volume.
std::shared_ptr<const Ingredient> pulling_around(const Model& model, const Vector3d& a,
                                                 bool volume_counts);
/// One of the above, or of stiffness_forms.h, by its variant; null: none.
std::shared_ptr<const Ingredient> fibre_form(const Model& model, const std::string& variant);
/// Those to try after `refitted`, a fibre with a free direction or one of these.
std::vector<NextForm> further_fibres(const Model& model, const Ingredient& refitted,
                                     const VectorXd& values);
/// What one of these says in words; empty: `ingredient` is none.
std::string fibre_sentence(const Model& model, const Ingredient& ingredient,
                           const VectorXd& values);

}  // namespace hookeye
