// What a fitted model says of the body place by place: where it is stiffer, where it has swollen.
#pragma once

#include <map>
#include <string>

#include "estimation/model/model.h"

namespace hookeye {

/// One value an element, by name; only those that effects have put into the model:
///   stiffness  energy's factor over the told material's, minus 1
///   swelling   linear stretch at which the element is free of stress, minus 1
std::map<std::string, VectorXd> fitted_fields(const ModelForm& form, const Model& realised);

}  // namespace hookeye
