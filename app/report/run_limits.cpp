#include "app/report/run_limits.h"

#include "capture_io/json_file.h"

namespace hookeye {

Limits limits_of(const nlohmann::json& timeline) {
  Limits out;
  const nlohmann::json told = timeline.value("options", nlohmann::json::object());
  expect_shape(told, {{"*", "number"}}, "options of run.json");
  for (const auto& [name, value] : told.items()) set_limit(out, name, value, "options of run.json");
  return out;
}

}  // namespace hookeye
