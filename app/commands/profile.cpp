// hookeye profile: where the time of a run's commands went.
#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "runs/kept_work.h"

namespace hookeye {
namespace {

std::string seconds(double value) { return value < 0.05 ? "-" : fmt::format("{:.1f}", value); }

/// CPU-seconds: a row a stage, a column a part that took any.
std::string work_table(const WorkTable& work) {
  std::array<double, kWorkParts> of_part{};
  for (const auto& stage : work.cpu_s)
    for (int p = 0; p < kWorkParts; ++p) of_part[p] += stage[p];
  std::vector<int> parts;
  for (int p = 0; p < kWorkParts; ++p)
    if (of_part[(p + 1) % kWorkParts] >= 0.05) parts.push_back((p + 1) % kWorkParts);
  std::vector<std::vector<std::string>> rows(1, {"CPU-seconds"});
  for (const int p : parts) rows[0].push_back(name_of(static_cast<WorkPart>(p)));
  rows[0].push_back("all");
  const auto add_row = [&](const std::string& name, const std::array<double, kWorkParts>& row) {
    double sum = 0.0;
    for (const double part : row) sum += part;
    if (sum < 0.05) return;
    rows.push_back({name});
    for (const int p : parts) rows.back().push_back(seconds(row[p]));
    rows.back().push_back(seconds(sum));
  };
  for (int s = 0; s < kWorkStages; ++s) add_row(name_of(static_cast<WorkStage>(s)), work.cpu_s[s]);
  add_row("all", of_part);
  return table(rows);
}

/// What the command did to the run.
std::string told(const CommandWork& work) {
  if (work.by_worker) return "a worker (`hookeye worker`)";
  if (work.steps == work.first_step) return fmt::format("a command on step {}", work.steps - 1);
  if (work.steps == work.first_step + 1)
    return fmt::format("the command of step {}", work.first_step);
  return fmt::format("the command of steps {} to {}", work.first_step, work.steps - 1);
}

void run_profile(const std::string& folder, Session& session) {
  const Run run = open_run(folder, false);
  const std::vector<CommandWork> all = work_of(run.folder());
  if (all.empty())
    throw InputError({folder}, "nothing is on record of where this run's time went",
                     "run another command on it: fit, add, discover and diagnose keep it");
  session.document["commands"] = work_json(all);
  for (const CommandWork& work : all)
    session.say("{}: {:.1f} s, {:.1f} CPU-seconds\n{}\n", told(work), work.table.wall_s,
                work.table.total(), work_table(work.table));
}

}  // namespace

void add_profile(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("profile", "Where the time of a run's commands went");
  const auto folder = std::make_shared<std::string>();
  command->add_option("RUN", *folder, "Run folder")->required();
  command->callback([&chosen, folder] {
    chosen = [folder](Session& session) { run_profile(*folder, session); };
  });
}

}  // namespace hookeye
