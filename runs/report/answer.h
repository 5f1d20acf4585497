// The answer first: what a run has found, in the order in which it is asked for. Terminal and page
// tell the same, from the run's own files.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace hookeye {

/// {material, headline, sentence, misfit, pixels, tested, effects}: the newest step's `material`
/// (material_card.h), with the intervals of its diagnosis where there is one; the verdict in a word
/// and in a plain sentence (what `discover` said, else what the step's own figures say); the misfit
/// in a sentence; what all pixels say where the fit has seen a part of them; what was added, with
/// intervals (effect_values.h). `metrics`, `diagnosis`: the newest step's files, null where they
/// are not there.
nlohmann::json answer_of(const nlohmann::json& timeline, const nlohmann::json& metrics,
                         const nlohmann::json& diagnosis);
/// Of the run in a folder, whose steps stand in `timeline`.
nlohmann::json answer_of(const std::filesystem::path& run, const nlohmann::json& timeline);

/// seen_in_words() of a run's capture, by the figures of one of its steps.
std::string seen_in_step(const std::filesystem::path& run, const std::filesystem::path& step);

/// The material as a table, with what it rests on; "" where there is none.
std::string material_text(const nlohmann::json& material);
/// All of it, within 100 columns.
std::string answer_text(const nlohmann::json& answer);

}  // namespace hookeye
