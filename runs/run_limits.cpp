#include "runs/run_limits.h"

#include "core/json_file.h"

namespace hookeye {

Limits limits_of(const nlohmann::json& timeline) {
  Limits out;
  const nlohmann::json told = timeline.value("options", nlohmann::json::object());
  expect_shape(told, {{"*", "number"}}, "options of run.json");
  for (const auto& [name, value] : told.items()) set_limit(out, name, value, "options of run.json");
  return out;
}

Limits limits_for(const std::filesystem::path& run, const std::vector<ToldLimit>& told) {
  Limits kept;
  bool steps = false;
  if (std::filesystem::exists(run / "run.json")) {
    const Run there = Run::open(run, false);
    kept = limits_of(there.timeline());
    steps = !there.steps().empty();
  }
  Limits limits = kept;
  for (const ToldLimit& one : told) set_limit(limits, one.name, one.value, one.place);
  if (steps && changed(limits) != changed(kept))
    throw InputError({run.string()}, "the steps of this run were made by other options",
                     "leave the options out, or name a new folder");
  return limits;
}

void keep_limits(Run& run, const Limits& limits) {
  const auto told = changed(limits);
  if (told.empty()) return;
  run.update([&](nlohmann::json& timeline) { timeline["options"] = told; });
}

}  // namespace hookeye
