// An ingredient some of whose numbers are told and do not move.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "estimation/model/model.h"

namespace hookeye {

/// `whole` without the parameters that `told` names, which stand at those values. Throws
/// std::invalid_argument for a name that is not one of its parameters, and for an ingredient with a
/// variant of its own.
std::shared_ptr<const Ingredient> hold(std::shared_ptr<const Ingredient> whole,
                                       const std::map<std::string, double>& told);

/// What a held ingredient tells in its variant, "holds kappa=0.42". Empty: it is none.
std::optional<std::map<std::string, double>> held_in(const std::string& variant);

}  // namespace hookeye
