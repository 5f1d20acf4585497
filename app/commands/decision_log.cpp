#include "app/commands/decision_log.h"

#include <fstream>

#include "capture_io/input_error.h"

namespace hookeye {

namespace {

constexpr const char* kFile = "decisions.jsonl";

}  // namespace

void DecisionLog::follow(const std::filesystem::path& step) {
  step_ = step;
  lines_.clear();
}

void DecisionLog::operator()(const Decision& decision) {
  if (step_.empty()) return;
  lines_ += to_json(decision).dump() + "\n";
  run_.add_file(
      step_, kFile,
      [&](const std::filesystem::path& file) { std::ofstream(file, std::ios::binary) << lines_; },
      true);
}

void log_naming(Run& run, const Diagnosis& diagnosis) {
  DecisionLog log(run);
  log.follow(run.steps().back());
  for (const Decision& one : naming_decisions(diagnosis)) log(one);
}

std::vector<Decision> decisions_of(const std::filesystem::path& step) {
  std::vector<Decision> out;
  std::ifstream file(step / kFile);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) try {
      out.push_back(decision_from_json(nlohmann::json::parse(line)));
    } catch (const std::exception& error) {
      throw InputError({(step / kFile).string(), number}, "this line is no decision",
                       "restore the file, or run `hookeye discover` into a new folder");
    }
  return out;
}

}  // namespace hookeye
