// One page of all captures of a batch. It holds no script, loads nothing, and links to the runs'
// own reports beside it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/batch_task.h"

namespace hookeye {

/// `rows`: as batch_rows() gives them (batch_index.h).
std::string fleet_page(const std::vector<nlohmann::json>& rows, const BatchOrder& order);

}  // namespace hookeye
