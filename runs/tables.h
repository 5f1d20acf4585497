// What a fit, a diagnosis and a search say on a terminal, within 100 columns.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "estimation/search/discover.h"

namespace hookeye {

/// All but the material's, which stand in the answer (runs/report/answer.h); effects in words; what
/// is not identifiable.
std::string parameter_table(const Fitted& fitted);
/// The leading `most` effects, one sentence on those that may be named, and why others were not
/// tested.
/// `seen`: seen_in_words() of the capture, here and below.
std::string diagnosis_table(const Diagnosis& diagnosis, const std::string& seen, size_t most = 10);
/// How the error fell over the steps of `run.json`, this run's and those it went on from.
std::string steps_table(const nlohmann::json& timeline);
/// What the effect that `step` of `run.json` added to `before` was chosen from, in multiples of the
/// floor, and how sure the choice is. Empty: nothing else stood out.
std::string choice_table(const nlohmann::json& before, const nlohmann::json& step, double floor,
                         const Limits& limits, const std::string& seen);

/// That the reference images are missed by far more than their noise, which hides what is wrong
/// with all photos alike; "" where they are not.
std::string high_floor(const Floor& floor);
/// Rest photos that repeat the noise of what they are compared with (Floor::copies); "": they do
/// not.
std::string copied_floor(const Floor& floor);

/// A number of `run.json`; 0: null, or left out.
double number_in(const nlohmann::json& object, const char* key);
/// "gravity", "strain_stiffening, without softening".
std::string name_of(const Step& step);
/// "1.234"; "-" where no photo counts (chi 0), as where nothing is held out.
std::string chi_text(double chi);
/// "1.04", in multiples of the floor, or as it is where none is known; 0: "-".
std::string times_floor(double chi, double floor);
/// What is to be said of a fit that stopped before its end; empty: it did not.
std::string not_converged(bool converged, int iterations);

}  // namespace hookeye
