// The additive energy model as the material of a model: all control values are parameters, and the
// structure (frame, addends, control points) is the variant, so that a step reads back the same.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/numerical_failure.h"
#include "estimation/model/model.h"
#include "simulation/additive.h"

namespace hookeye {

/// Which of a capture's materials: its part of the energy, and its name where there are several.
struct MaterialPlace {
  int part = 0;
  std::string label;  ///< "" : the only one
};

/// Ingredient "material" over one part of the energy. Parameters "E11.1", "head.E11.1". Exact
/// derivatives of all control values in one pass.
std::shared_ptr<const Ingredient> additive_material(const AdditiveModel& model, const Units& units,
                                                    const MaterialPlace& place = {});
/// By variant(); throws std::invalid_argument for a text that is not one.
std::shared_ptr<const Ingredient> additive_material_from(const std::string& variant,
                                                         const Units& units);

/// Its part of the energy is one of the capture's materials, of the same name.
bool fits_capture(const Ingredient& additive_material, const Capture& capture);

/// An additive material of a form, where its values begin among the parameters, and the model with
/// the values of p. In the order of the form.
struct AdditivePart {
  int offset = 0;
  MaterialPlace place;
  AdditiveModel model;
};
std::vector<AdditivePart> additive_parts(const ModelForm& form, const VectorXd& p);
bool has_additive(const ModelForm& form);
/// One of the capture's materials is additive, whatever of it is fitted.
bool has_additive(const Model& model);

/// What effects add to additive materials (additive_function.h), with where the control values come
/// from: values() = by_p * p.
struct AddedPart {
  std::string name;  ///< the effect
  ConvexPart functions;
};
std::vector<AddedPart> added_parts(const ModelForm& form, const VectorXd& p);
/// What must be convex: every additive material with all that effects add to it; added functions in
/// another frame stand alone. `by_x` is by p.
std::vector<ConvexPart> convex_parts(const ModelForm& form, const VectorXd& p);

/// The form with its materials told additively, at the same energy where that is possible
/// (as_additive), else at a neo-Hookean one with the same moduli at rest. A barrier on J is added
/// below 0.3 where a material has none, as stiff as the material at rest in volume.
std::pair<ModelForm, VectorXd> to_additive(const ModelForm& form, const VectorXd& p);
/// The same form and values with other structures of the additive materials, in their order.
std::pair<ModelForm, VectorXd> with_structures(const ModelForm& form, const VectorXd& p,
                                               const std::vector<AdditiveModel>& models);

/// The smallest eigenvalue over the additive materials of a model, each with what effects add to
/// it. Empty: it has none.
std::optional<ConvexityTest> smallest_eigenvalue(const Model& model);
/// Where that is negative (fit: [E11.1] moves named values freely; additive ingredients stay convex
/// by themselves). Empty: nowhere.
std::optional<NumericalFailure> not_convex(const Model& model);

/// Adds frames that vary over the body to a part, where the law asks for them.
void set_frames(EnergyModel::Part& part, const TetMesh& mesh);

}  // namespace hookeye
