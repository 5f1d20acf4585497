#include "runs/decision_log.h"

#include <ctime>
#include <fstream>

#include "core/input_error.h"

namespace hookeye {

namespace {

constexpr const char* kFile = "decisions.jsonl";

/// Of all threads.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

DecisionLog::DecisionLog(Run& run) : run_(run), before_(cpu_seconds()) {}

void DecisionLog::follow(const std::filesystem::path& step) {
  step_ = step;
  lines_.clear();
}

void DecisionLog::operator()(Decision decision) {
  const double now = cpu_seconds();
  decision.cpu_s = now - before_;
  before_ = now;
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
