// Forms of anisotropy beside fibres that pull and push alike: those that only pull, stiffnesses of
// their own.
#pragma once

#include "estimation/effects/toolbox.h"

namespace hookeye {

/// The axis turned by small angles about two axes normal to it.
Vector3d turned(const Vector3d& a, double t1, double t2);

/// As scored: W += k/2 (I4 - 1)^2 in tension, isochoric, 0 in compression, along `a`.
std::shared_ptr<const Ingredient> pulling_along(const Model& model, const Vector3d& a);
/// Its refit, pulling_around(), with `values` moved to it; null: `scored` is none.
std::shared_ptr<const Ingredient> refit_of_pulling(const Model& model, const Ingredient& scored,
                                                   VectorXd& values);
/// W += k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1) in tension, 0 in compression, the fibre's direction free
/// around `a`; I4 isochoric or with the volume.
std::shared_ptr<const Ingredient> pulling_around(const Model& model, const Vector3d& a,
                                                 bool volume_counts);
/// Transverse isotropy in the Green strain, W += k/2 E_aa^2 + c E_aa (E_bb + E_cc) + 2 g (E_ab^2 +
/// E_ac^2): a modulus along the fibre, a shear modulus of its own and a coupling (the small-strain
/// constants E1, E2 = E3, nu12, G12 beside the base law's), direction free around `a`.
std::shared_ptr<const Ingredient> transverse_around(const Model& model, const Vector3d& a);
/// Orthotropy in the Green strain around the frame whose first axis is `a`, its orientation free:
/// all stiffnesses but g23, which is the base law's shear modulus.
std::shared_ptr<const Ingredient> orthotropic_around(const Model& model, const Vector3d& a);

/// One of the above by its variant; null: none.
std::shared_ptr<const Ingredient> fibre_form(const Model& model, const std::string& variant);
/// Those to try after `refitted`, a fibre with a free direction or one of the above.
std::vector<Effect::Further> further_fibres(const Model& model, const Ingredient& refitted,
                                            const VectorXd& values);
/// What one of the above says in words; empty: `ingredient` is none.
std::string fibre_sentence(const Model& model, const Ingredient& ingredient,
                           const VectorXd& values);

}  // namespace hookeye
