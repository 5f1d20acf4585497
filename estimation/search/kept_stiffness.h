// Where a model starts when an effect on the stiffness takes another form. Internal to discover.
#pragma once

#include "estimation/model/model.h"

namespace hookeye {

/// p of `form` with moduli times what scales most of the body more in `model` than it does there:
/// a field over all of the body shares its mean with the modulus, and neither tells the two apart.
/// A form that starts from that modulus without the field's mean would start by that factor off.
VectorXd with_stiffness_of(const Model& model, const ModelForm& form, VectorXd p);

}  // namespace hookeye
