#include "runs/work_log.h"

#include <fstream>

#include "core/json_file.h"

namespace hookeye {

WorkTable worked_since(const WorkTable& before) {
  WorkTable out = worked();
  out.wall_s -= before.wall_s;
  for (int s = 0; s < kWorkStages; ++s)
    for (int p = 0; p < kWorkParts; ++p) out.cpu_s[s][p] -= before.cpu_s[s][p];
  return out;
}

std::string work_line(const CommandWork& work) {
  nlohmann::json cpu = nlohmann::json::object();
  for (int s = 0; s < kWorkStages; ++s)
    for (int p = 0; p < kWorkParts; ++p)
      if (work.table.cpu_s[s][p] > 0.0)
        cpu[name_of(static_cast<WorkStage>(s))][name_of(static_cast<WorkPart>(p))] =
            work.table.cpu_s[s][p];
  nlohmann::json out = {{"first_step", work.first_step},
                        {"steps", work.steps},
                        {"wall_s", work.table.wall_s},
                        {"cpu_s", std::move(cpu)}};
  if (work.by_worker) out["worker"] = true;
  return out.dump();
}

std::vector<CommandWork> work_of(const std::filesystem::path& run) {
  std::vector<CommandWork> out;
  std::ifstream file(run / kWorkFile);
  for (std::string line; std::getline(file, line);) {
    std::string damage;
    const auto told = parse_json(line, damage);
    if (!told || !told->is_object()) continue;
    try {
      CommandWork work{told->at("first_step"), told->at("steps"), {}, told->value("worker", false)};
      work.table.wall_s = told->at("wall_s");
      for (int s = 0; s < kWorkStages; ++s)
        for (int p = 0; p < kWorkParts; ++p)
          work.table.cpu_s[s][p] =
              told->at("cpu_s")
                  .value(name_of(static_cast<WorkStage>(s)), nlohmann::json::object())
                  .value(name_of(static_cast<WorkPart>(p)), 0.0);
      out.push_back(work);
    } catch (const nlohmann::json::exception&) {
      continue;
    }
  }
  return out;
}

nlohmann::ordered_json work_json(const std::vector<CommandWork>& all) {
  auto out = nlohmann::ordered_json::array();
  for (const CommandWork& work : all) {
    nlohmann::ordered_json cpu;
    for (int s = 0; s < kWorkStages; ++s)
      for (int p = 0; p < kWorkParts; ++p)
        cpu[name_of(static_cast<WorkStage>(s))][name_of(static_cast<WorkPart>(p))] =
            work.table.cpu_s[s][p];
    out.push_back({{"first_step", work.first_step},
                   {"steps", work.steps},
                   {"wall_s", work.table.wall_s},
                   {"cpu_s", std::move(cpu)}});
    if (work.by_worker) out.back()["worker"] = true;
  }
  return out;
}

}  // namespace hookeye
