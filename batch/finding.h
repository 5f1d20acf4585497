// What a capture's process came to: the row of the index.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace hookeye {

/// Of a run folder, as other commands read it: {verdict, sentence, found, tie, parameters, chi_fit,
/// chi_validate, floor, rms_px}. Values are null where the run does not tell them. Throws
/// InputError where it cannot be read.
nlohmann::json finding_of_run(const std::filesystem::path& run);

/// Of a verb that makes no run, by what it warned of: {verdict: "2 warnings", sentence: the first}.
nlohmann::json finding_of_log(const std::filesystem::path& log);

/// The first line of what went wrong, of the document that --json prints, else the last line of the
/// log. "": neither tells.
std::string error_line(const std::filesystem::path& document, const std::filesystem::path& log);

}  // namespace hookeye
