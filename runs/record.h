// What is written into a run, step by step.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "estimation/diagnosis/free_form.h"
#include "runs/bench.h"

namespace hookeye {

/// Effects that the refits of a step of `run.json` could not tell apart, the added one first; one
/// alone is no tie.
std::vector<std::string> tied_in(const nlohmann::json& step, const Limits& limits);
/// Who stood in its contest.
Contested contested_in(const nlohmann::json& step);

/// Where photos were read in part: the newest step, which is `step`, over all pixels
/// (over_all_pixels.h). Its files that follow from that are made anew; its entry and `step` get the
/// intervals, and the entry `all_pixels`. Once a step: what is on record is taken as it is.
void record_all_pixels(Run& run, Bench& bench, Step& step, const FitOptions& options);

/// Writes the step's folder and the timeline's entry, which keeps the command that made it. The
/// run's verdict goes: it was about the step before. So does `search`, unless the step is of it.
std::filesystem::path record(Run& run, const Step& step, const std::string& command,
                             bool of_search = false);
/// The lowest floor that any step of the run has shown: a model that lacks something leaves some of
/// it in the rest photos too.
void tell_floor(nlohmann::json& timeline, const Floor& floor);
/// The step with all that record() writes of its diagnosis (lacks_displaced).
Step with_displaced(Bench& bench, Step step, const std::atomic<bool>* cancel);
/// Puts a diagnosis into the newest step and the timeline. What the fit wrote stays as it is.
void record_diagnosis(Run& run, const Step& step);

/// Diagnoses the newest step and writes it down; its intervals reach for the mesh.
void diagnose_newest(Run& run, Bench& bench, Step& step, const DiagnosisOptions& options);

/// Of the forces that free_form() finds, so many are drawn.
inline constexpr size_t kDrawnFreeForms = 3;
/// Where the photos are not explained: the forces that would explain them (free_form.h), written
/// beside the newest step's diagnosis. For when no effect of the catalogue is left to try. Empty:
/// they are explained.
std::vector<FreeForm> tell_free_form(const Run& run, Bench& bench, const Step& step,
                                     const std::atomic<bool>* cancel);

}  // namespace hookeye
