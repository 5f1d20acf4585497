// --set and --options: the numbers that a fit, a floor, a diagnosis and a search decide by.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "runs/run_limits.h"

namespace hookeye {

/// `told`: NAME=VALUE of every --set.
void add_limit_options(CLI::App& command, std::vector<std::string>& told);

/// As they were told. Throws InputError for what is no NAME=NUMBER.
std::vector<ToldLimit> told_limits(const std::vector<std::string>& told);

/// All of them as a table, with unit, reason and source.
std::string limits_table();

}  // namespace hookeye
