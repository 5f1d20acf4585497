// What makes a step: the versions for run.json and the page, the program for the archive.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace hookeye {

/// {"hookeye": "0.1.0", "compiler": ..., "Ceres": ...}
nlohmann::json versions();

}  // namespace hookeye
