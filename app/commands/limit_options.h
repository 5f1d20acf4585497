// --set and --options: the numbers that a fit, a floor, a diagnosis and a search decide by.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "capture_io/run.h"
#include "estimation/model/limits.h"

namespace hookeye {

/// `told`: NAME=VALUE of every --set.
void add_limit_options(CLI::App& command, std::vector<std::string>& told);

/// Those that a run keeps, where there is one in `run`, with what is told now. Throws InputError
/// where it has steps that were made by others.
Limits limits_for(const std::filesystem::path& run, const std::vector<std::string>& told);

/// Writes those that are not standard into run.json.
void keep_limits(Run& run, const Limits& limits);

/// All of them as a table, with unit, reason and source.
std::string limits_table();

}  // namespace hookeye
