// RUN/work.jsonl: where the time of a run's commands went, a line a command.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/work_clock.h"

namespace hookeye {

constexpr const char* kWorkFile = "work.jsonl";

/// One command's work on a run.
struct CommandWork {
  size_t first_step = 0, steps = 0;  ///< the run had so many steps before and after
  WorkTable table;
  bool by_worker = false;  ///< of one that helped another command (search_worker.h)
};

/// Processor and wall time since then.
WorkTable worked_since(const WorkTable& before);
/// Its line.
std::string work_line(const CommandWork& work);
/// What RUN/work.jsonl tells, in the order of the commands; lines that are damaged are left out.
std::vector<CommandWork> work_of(const std::filesystem::path& run);
/// [{first_step, steps, wall_s, cpu_s: {STAGE: {PART: seconds}}}]; `worker: true` of one.
nlohmann::ordered_json work_json(const std::vector<CommandWork>& all);

}  // namespace hookeye
