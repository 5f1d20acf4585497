#include "runs/decision_log.h"

#include <fmt/format.h>

#include <cmath>
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

namespace {

/// What the numbers of a question are, by the option that the limit follows from; "*": by any. {0}:
/// the number, {1}: what it was held against.
struct Meaning {
  Asked asked;
  const char* option;
  const char* words;
};
constexpr Meaning kMeanings[] = {
    {Asked::named, "*", "log Bayes factor {0}; a name takes {1}"},
    {Asked::screened, "search.promises",
     "would remove {0} of the excess misfit; {1} takes a trial"},
    {Asked::screened, "search.second_round", "place {0}; the first {1} go on"},
    {Asked::screened, "search.out_of_reach", "residual, fitted plus held out: {0}; at most {1}"},
    {Asked::screened, "", "residual, fitted plus held out: {0}; {1} without it"},
    {Asked::refitted, "search.out_of_reach", "residual, fitted plus held out: {0}; at most {1}"},
    {Asked::refitted, "search.leaders",
     "residual, fitted plus held out: {0}; the first one's: {1}"},
    {Asked::refitted, "search.may_tie", "residual over the noise floor: {0}; an equal has {1}"},
    {Asked::refitted, "floor.at", "residual {0}; explained from {1} down"},
    {Asked::ranked, "*", "penalised log likelihood over the best one's: {0}"},
    {Asked::stands, "diagnosis.nameable", "penalised log likelihood gained: {0}; it takes {1}"},
    {Asked::stands, "diagnosis.tie",
     "squared residual of what is held out rises by {0}; allowed: {1}"},
    {Asked::stands, "floor.err_share",
     "squared residual falls by {0}; renderers and meshes err by {1}"},
    {Asked::stands, "search.worth_a_name", "share of the excess misfit left: {0}; at most {1}"},
    {Asked::widened, "search.widening_leaves", "share left: {0}; at most {1}"},
    {Asked::widened, "", "difference {0}; it takes {1}"},
    {Asked::dropped, "floor.at", "residual {0}; explained from {1} down"},
    {Asked::dropped, "*", "difference {0}; at least {1}"},
    {Asked::swapped, "*", "difference {0}; it takes {1}"},
    {Asked::tied, "*", "difference {0}; a tie from {1} up"},
    {Asked::scored, "*", "score {0}; no fit of it exceeds {1}"},
    {Asked::ended, "floor.at", "residual {0}; explained from {1} down"},
    {Asked::ended, "floor.chance", "given up: {0}; at most {1}"},
};

}  // namespace

std::string number_in_words(const Decision& decision) {
  const Compared& by = decision.by;
  if (!std::isfinite(by.value)) return {};
  const auto text = [](double number) { return fmt::format("{:.4g}", number); };
  for (const Meaning& one : kMeanings)
    if (one.asked == decision.asked && std::isfinite(by.limit) &&
        (one.option == by.option || one.option == std::string("*")))
      return fmt::format(fmt::runtime(one.words), text(by.value), text(by.limit));
  return std::isfinite(by.limit) ? text(by.value) + " against " + text(by.limit) : text(by.value);
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
