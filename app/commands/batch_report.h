// What `hookeye batch` says at its end, and its document.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "app/session.h"
#include "batch/batch_folder.h"

namespace hookeye {

/// Fills the document, says counts, effects and failures, and sets the exit status: 3 where
/// captures failed.
void report_batch(const BatchFolder& folder, const std::vector<nlohmann::json>& rows,
                  Session& session);

}  // namespace hookeye
