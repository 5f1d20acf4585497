// A refit with an effect in the form that the user names.
#pragma once

#include <string>
#include <vector>

#include "estimation/search/refit.h"

namespace hookeye {

/// Names of the forms that the effect may take beside the others of the model (form_name), each
/// once; empty: one form without a name, or none.
std::vector<std::string> form_names(const Effect& effect, const Model& model);

/// Refits with one effect as add_effect() does, and ends in the form of that name. A form that only
/// a refit goes on to is started where the refit says that it is most like what it came to; a
/// scored one, in the best of its ways. A failure where no way leads there.
Result<Fitted> add_effect_as(Workspace& workspace, const Fitted& current, const EffectScore& score,
                             const std::string& form, const FitOptions& options,
                             const DiagnosisOptions& diagnosis);

}  // namespace hookeye
