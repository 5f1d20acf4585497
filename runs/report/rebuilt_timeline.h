// The timeline of a run whose run.json is lost, as far as its steps tell it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

namespace hookeye {

/// {floor, steps} from each step's metrics.json, diagnosis.json and parameters.csv; what cannot be
/// read is left out. Reads only. Who made the steps, their rivals and the verdict stood in run.json
/// alone.
nlohmann::json rebuilt_timeline(const std::vector<std::filesystem::path>& steps);

}  // namespace hookeye
