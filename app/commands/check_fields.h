// Measured fields as `check` understood them.
#pragma once

#include <nlohmann/json.hpp>

#include "app/session.h"
#include "estimation/model/model.h"

namespace hookeye {

/// By example and file: points, how many numbers they are, how far they lie off the surface.
nlohmann::ordered_json describe_fields(const Scene& scene);
void say_fields(const Scene& scene, const nlohmann::ordered_json& fields, const Session& session);
/// Of units that nobody tells, dropped rows, and noise that the fields themselves contradict.
void warn_of_fields(const Scene& scene, Session& session);

}  // namespace hookeye
