// What makes a step: the versions for run.json and the page, the program for the archive.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace hookeye {

/// {"hookeye": "0.2.0", "git": "5e03c78", "compiler": ..., "Ceres": ...}; no "git" where that is
/// not known.
nlohmann::json versions();

/// "0.2.0" of a release, "0.2.0 (v0.2.0-12-g5e03c78)" of what lies between, as `git describe` tells
/// it
/// ("-dirty": with changes that were not committed).
std::string version_text();

}  // namespace hookeye
