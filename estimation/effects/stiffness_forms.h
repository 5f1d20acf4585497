// Forms of anisotropy with stiffnesses of their own, quadratic in the Green strain E: transverse
// isotropy, orthotropy, all constants. And what all forms of anisotropy are told by.
#pragma once

#include "estimation/effects/toolbox.h"

namespace hookeye {

/// The axis turned by small angles about two axes normal to it.
Vector3d turned(const Vector3d& a, double t1, double t2);
/// The direction in the variant's text.
Vector3d base_axis(const Ingredient& ingredient);
/// Those of turned().
std::vector<Parameter> fibre_angles();
/// A modulus of anisotropy, at least `least` times the base law's shear modulus.
Parameter modulus_of(const Model& model, const std::string& name, const std::string& long_name,
                     double least);

/// By its variant; null: none.
///   transverse: W += k/2 E_aa^2 + c E_aa (E_bb + E_cc) + 2 g (E_ab^2 + E_ac^2), a modulus along
///   the fibre, a shear modulus of its own and a coupling (the small-strain constants E1, E2 = E3,
///   nu12, G12 beside the base law's), direction free; orthotropic: all stiffnesses but g23, which
///   is the base law's shear modulus, orientation free; linear orthotropic: the same where a share
///   of the base law, isotropic at rest, is linear between second Piola-Kirchhoff stress and Green
///   strain too, in volume as in shape: at 1 the whole material is the orthotropic St
///   Venant-Kirchhoff law that FEM codes have for engineering constants; all: all 21 constants but
///   C44, which the base law's shear modulus stands for, and the share: without an axis that could
///   be a wrong one, and but for the share linear in its values.
std::shared_ptr<const Ingredient> stiffness_form(const Model& model, const std::string& variant);
/// Those to try after a fibre of modulus `k` along `a`.
std::vector<NextForm> stiffnesses_after_fibre(const Model& model, const Vector3d& a, double k);
/// Those to try after one of the above.
std::vector<NextForm> further_stiffnesses(const Model& model, const Ingredient& refitted,
                                          const VectorXd& values);
/// Linear orthotropy that is most like all constants; empty: `refitted` is not that form.
std::vector<NextForm> plainer_stiffnesses(const Model& model, const Ingredient& refitted,
                                          const VectorXd& values);
/// What one of the above says in words; empty: `ingredient` is none.
std::string stiffness_sentence(const Model& model, const Ingredient& ingredient,
                               const VectorXd& values);

}  // namespace hookeye
