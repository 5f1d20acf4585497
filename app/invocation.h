// The exact command and the versions that make a step, for run.json and the page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace hookeye {

/// Called once by main().
void remember_invocation(int argc, char** argv);
/// The command line as it may be given to a shell again.
std::string invocation();
std::string shell_word(const std::string& word);

/// {"hookeye": "0.1.0", "compiler": ..., "Ceres": ...}
nlohmann::json versions();

}  // namespace hookeye
