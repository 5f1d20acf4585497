// What the model's residual would be with an effect, before any refit: the diagnosis' linear step
// taken, equilibrium and pictures computed again.
#pragma once

#include <nlohmann/json.hpp>
#include <variant>

#include "estimation/diagnosis.h"

namespace hookeye {

/// Per photo (EXAMPLE-CAMERA), for every cell that counts now and then: column, row, root mean
/// square residual over noise now, and with the effect (base64 float32, 4 a cell).
/// {"cell_px", "photos": {NAME: {"cells": {components, float32}}}}
std::variant<nlohmann::json, NumericalFailure> predict_effect(Workspace& workspace,
                                                              const Fitted& fitted,
                                                              const EffectScore& score,
                                                              const std::atomic<bool>* cancel);

}  // namespace hookeye
