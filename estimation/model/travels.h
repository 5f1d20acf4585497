// Travels of supports that are prescribed and measured.
#pragma once

#include <memory>

#include "estimation/model/model.h"

namespace hookeye {

/// One number for each support whose prescribed travel is measured along its direction
/// (`travel_of`, or `sigma` beside `move`): by how much it went farther [length]. The measurement
/// keeps it near 0, in held-out examples too. What no number stands for a search would name an
/// effect for. Null: there is none.
std::shared_ptr<const Ingredient> travel_ingredient(const Scene& scene);

}  // namespace hookeye
