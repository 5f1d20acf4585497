// By which options a run was made.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/model/limits.h"

namespace hookeye {

/// `options` of run.json, by name; those that it does not tell are standard. Throws InputError for
/// one that is none, as another version may write.
Limits limits_of(const nlohmann::json& timeline);

}  // namespace hookeye
