// What a fit, a diagnosis and a search say on a terminal, within 100 columns.
#pragma once

#include <string>

#include "estimation/discover.h"

namespace hookeye {

std::string parameter_table(const Fitted& fitted);
/// The leading `most` effects, one sentence on those that may be named, and why others were not
/// tested.
std::string diagnosis_table(const Diagnosis& diagnosis, size_t most = 10);
/// How the error fell.
std::string steps_table(const Discovery& discovery);
/// What the effect that was added to `before` was chosen from. Empty: nothing else stood out.
std::string choice_table(const Step& before, const Step& step);

/// "gravity", "strain_stiffening, without softening".
std::string name_of(const Step& step);
/// "1.234"; "-" where no photo counts (chi 0), as where nothing is held out.
std::string chi_text(double chi);

}  // namespace hookeye
