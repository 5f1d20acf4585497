// Functions of strain components on top of a material, told in the additive language: what an
// effect of the material adds to an additive one, and what a refinement would add.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/model/model.h"
#include "simulation/additive.h"

namespace hookeye {

struct FunctionSpec {
  std::string name, variant;
  /// Nulls are zeros.
  std::vector<Parameter> parameters;
  /// The functions at some values. Control values are linear in the parameters and zero at zero; a
  /// parameter may also turn a direction and leave the control values alone.
  std::function<AdditiveModel(const VectorXd& values)> functions;
  /// Acts where this part of the energy does, weighted alike; -1: everywhere.
  int like_part = -1;
};
std::shared_ptr<const Ingredient> additive_function(FunctionSpec spec);

/// What such an ingredient adds at some values, and the derivative of its control values by its
/// parameters. Empty for any other ingredient.
struct AddedFunctions {
  AdditiveModel model;
  Eigen::MatrixXd by_values;
};
std::optional<AddedFunctions> added_functions(const Ingredient& ingredient, const VectorXd& values);

}  // namespace hookeye
