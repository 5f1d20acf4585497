// By which options a run was made.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capture_io/run.h"
#include "estimation/model/limits.h"

namespace hookeye {

/// `options` of run.json, by name; those that it does not tell are standard. Throws InputError for
/// one that is none, as another version may write.
Limits limits_of(const nlohmann::json& timeline);

/// One of them, told by a user: `place` is where ("--set").
struct ToldLimit {
  std::string name;
  double value = 0.0;
  std::string place;
};

/// Those that a run keeps, where there is one in `run`, with what is told now. Throws InputError
/// where it has steps that were made by others.
Limits limits_for(const std::filesystem::path& run, const std::vector<ToldLimit>& told);

/// Writes those that are not standard into run.json.
void keep_limits(Run& run, const Limits& limits);

}  // namespace hookeye
