// The additive energy model as the material of a model: all control values are parameters, and the
// structure (frame, addends, control points) is the variant, so that a step reads back the same.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "capture_io/numerical_failure.h"
#include "estimation/model.h"
#include "simulation/additive.h"

namespace hookeye {

/// Ingredient "material" over the first part of the energy, which must be the only one at the start
/// (one material for the whole body). Exact derivatives of all control values in one pass.
std::shared_ptr<const Ingredient> additive_material(const AdditiveModel& model, const Units& units);
/// Structure and starting values of such an ingredient; null for any other.
const AdditiveModel* additive_structure(const Ingredient& ingredient);
/// By variant(); throws std::invalid_argument for a text that is not one.
std::shared_ptr<const Ingredient> additive_material_from(const std::string& variant,
                                                         const Units& units);

/// The additive ingredient of a form, where its values begin among the parameters, and the model
/// with the values of p. Index -1: the form has none.
struct AdditivePart {
  int ingredient = -1, offset = 0;
  AdditiveModel model;
};
AdditivePart find_additive(const ModelForm& form, const VectorXd& p);

/// The form with its material told additively, at the same energy where that is possible
/// (as_additive), else at a neo-Hookean one with the same moduli at rest. A barrier on J is added
/// below 0.3 where the material has none, as stiff as the material at rest in volume.
/// Throws InputError where the capture tells several materials.
std::pair<ModelForm, VectorXd> to_additive(const ModelForm& form, const VectorXd& p);
/// The same form and values with another structure of the additive material.
std::pair<ModelForm, VectorXd> with_structure(const ModelForm& form, const VectorXd& p,
                                              const AdditiveModel& model);

/// Where an additive part of the energy is not convex (fit: [E11.1] moves named values freely; the
/// additive ingredient stays convex by itself). Empty: nowhere.
std::optional<NumericalFailure> not_convex(const Model& model);

/// Adds frames that vary over the body to a part, where the law asks for them.
void set_frames(EnergyModel::Part& part, const TetMesh& mesh);

}  // namespace hookeye
