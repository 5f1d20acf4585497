// What a search decided is on disk, and `explain` tells it with its number and its line.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <utility>
#include <vector>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

TEST_F(FittedRun, EveryDecisionIsToldWithItsNumberAndItsLine) {
  EXPECT_EQ(hookeye("explain run").status, 2);  // nothing was asked yet
  const Result found = hookeye("discover capture -o run");
  ASSERT_EQ(found.status, 0) << found.err;

  // What it says on its way stands for itself, too.
  EXPECT_THAT(found.err,
              AllOf(ContainsRegex("screening of gravity on half-size photos: normalised residual "
                                  "[0-9.]+ on fitted photos \\([0-9.]+ without it\\), [0-9.]+ on "
                                  "held-out ones \\([0-9.]+\\); noise floor ([0-9.]+|unknown)"),
                    ContainsRegex("with gravity: normalised residual [0-9.]+ on fitted photos "
                                  "\\([0-9.]+ without it\\)"),
                    ContainsRegex("decided: gravity is added: .*penalised log likelihood")));
  const Result all = hookeye("explain run");
  ASSERT_EQ(all.status, 0) << all.err;
  EXPECT_THAT(all.out,
              AllOf(HasSubstr("beyond the model of step 00-base: its normalised residual is "),
                    ContainsRegex("gravity \\([0-9.]+ CPU-s\\), stands: "),
                    HasSubstr("effects do not stand out"), HasSubstr("the search ended")));
  const Result gravity = hookeye("explain run gravity");
  EXPECT_THAT(gravity.out,
              AllOf(HasSubstr("stands out"), HasSubstr("refitted"), HasSubstr("says most"),
                    HasSubstr("diagnosis.nameable"), Not(HasSubstr("swelling, "))));
  // Each number has a name, and what it is held against beside it.
  std::string words;
  for (const char c : gravity.out)
    if (!std::isspace(static_cast<unsigned char>(c)) || (!words.empty() && words.back() != ' '))
      words += std::isspace(static_cast<unsigned char>(c)) ? ' ' : c;
  EXPECT_THAT(words,
              AllOf(ContainsRegex("\\(log Bayes factor [0-9.]+; a name takes [0-9.]+: "),
                    ContainsRegex("one step of its refit, on half-size photos: normalised residual "
                                  "[0-9.]+ on fitted photos, [0-9.]+ on held-out ones; without it "
                                  "[0-9.]+ and [0-9.]+; noise floor ([0-9.]+|unknown)"),
                    ContainsRegex("normalised residual [0-9.]+ on fitted photos, [0-9.]+ without "
                                  "it; noise floor [0-9.]+"),
                    ContainsRegex("penalised log likelihood")));
  // The line that it names is in the sources, and tells a decision.
  const std::string text = gravity.out;
  const size_t at = text.rfind("[estimation/"), colon = text.find(':', at);
  ASSERT_NE(at, std::string::npos);
  std::ifstream source(std::string(HOOKEYE_SOURCE_DIR "/") + text.substr(at + 1, colon - at - 1));
  std::string line;
  for (int number = std::stoi(text.substr(colon + 1)); number > 0; --number)
    ASSERT_TRUE(std::getline(source, line));
  EXPECT_THAT(line, ContainsRegex("tell|told")) << text;

  const json document = json::parse(hookeye("explain run swelling --json").out);
  const json& first = document.at("steps").at(0).at("decisions").at(0);
  EXPECT_EQ(first.at("asked"), "named");
  EXPECT_EQ(first.at("candidate"), "swelling");
  EXPECT_EQ(hookeye("explain run gravty").status, 2);

  // The score in the shadow: its terms add up, so do differences of a step, and what is hidden is
  // first among the refits of its contest.
  EXPECT_THAT(all.out, AllOf(Not(HasSubstr("score that decides nothing")),
                             HasSubstr("`hookeye explain run --scores` adds a second score")));
  EXPECT_THAT(gravity.out, Not(HasSubstr("score in the shadow")));
  const Result sure = hookeye("explain run --scores");
  EXPECT_THAT(sure.out, AllOf(HasSubstr("How sure, by a score that decides nothing yet"),
                              Not(HasSubstr("adds a second score"))));
  EXPECT_THAT(hookeye("explain run gravity --scores").out, HasSubstr("score in the shadow"));

  // A step has the floor that its own diagnosis has, whatever the newest one's is.
  json timeline = json::parse(read(folder_ / "run/run.json"));
  const json kept = timeline;
  timeline["floor"]["chi"] = 0.123;
  write("run/run.json", timeline.dump());
  const json base = json::parse(read(folder_ / "run/steps/00-base/diagnosis.json"));
  const std::string heading = hookeye("explain run").out.substr(0, 700);
  EXPECT_THAT(heading, AllOf(ContainsRegex(fmt::format("noise[ \n]+floor[ \n]+{:.3f}",
                                                       base.at("floor").at("chi").get<double>())),
                             Not(HasSubstr("0.123"))));
  write("run/run.json", kept.dump());
  size_t most = 0;
  std::string first_by_score;
  const json told = json::parse(hookeye("explain run --json").out);
  for (const json& step : told.at("steps")) {
    // Two refits of one model may have come to two places.
    std::vector<std::pair<std::string, json>> scored;
    for (const json& line : step.at("decisions"))
      if (line.at("asked") == "scored") scored.emplace_back(line.at("candidate"), line);
    most = std::max(most, scored.size());
    const auto best = std::find_if(scored.begin(), scored.end(), [](const auto& one) {
      return one.second.at("parts").at("below_best") == 0.0;
    });
    if (scored.empty()) continue;
    ASSERT_NE(best, scored.end());
    if (first_by_score.empty() && std::any_of(scored.begin(), scored.end(), [](const auto& one) {
          return one.first.ends_with("gravity");
        }))
      first_by_score = best->first;
    for (const auto& [model, line] : scored) {
      const json& parts = line.at("parts");
      const double total = line.at("value");
      EXPECT_LE(total, line.at("limit").get<double>()) << model;
      EXPECT_NEAR(total,
                  parts.at("fitted").get<double>() + parts.at("held_out").get<double>() +
                      parts.at("prior").get<double>(),
                  1e-6);
      EXPECT_NEAR(total - best->second.at("value").get<double>(),
                  parts.at("below_best").get<double>(), 1e-6);
    }
  }
  EXPECT_GE(most, 2u);
  EXPECT_THAT(first_by_score, HasSubstr("gravity"));

  // Where the time went: its parts are those of the work, and a damaged line hides no other.
  std::ofstream(folder_ / "run/work.jsonl", std::ios::app) << "{\n";
  const Result profile = hookeye("profile run");
  EXPECT_THAT(profile.out, AllOf(HasSubstr("the command of step"), HasSubstr("rays"),
                                 HasSubstr("equilibria"), HasSubstr("diagnosis")));
  const json commands = json::parse(hookeye("profile run --json").out).at("commands");
  ASSERT_EQ(commands.size(), 2u) << "a fit and a search";
  const json& cpu_s = commands.at(1).at("cpu_s");
  double cpu = 0.0;
  for (const auto& stage : cpu_s)
    for (const auto& part : stage) cpu += part.get<double>();
  EXPECT_GT(cpu_s.at("diagnosis").at("equilibria").get<double>(), 0.0);
  EXPECT_GT(cpu_s.at("fit").at("rays").get<double>(), 0.0);
  EXPECT_LT(cpu_s.at("fit").at("other").get<double>(), 0.5 * cpu);

  std::ofstream(folder_ / "run/steps/00-base/decisions.jsonl", std::ios::app) << "{\n";
  const Result damaged = hookeye("explain run");
  EXPECT_EQ(damaged.status, 2);
  EXPECT_THAT(damaged.err, ContainsRegex("decisions.jsonl:[0-9]+"));
}

/// The same capture with one example that nothing may see. Searches add a finer mesh and one
/// effect.
class WithATest : public Cli {
 protected:
  Result search(const std::string& run) const {
    return hookeye("discover capture --set search.max_effects=2 -o " + run);
  }
  void SetUp() override {
    Cli::SetUp();
    std::string recipe = kSmallRecipe;
    recipe.insert(recipe.find("hidden:"), "  press: {use: test, force: [0, 0.03, 0.2]}\n");
    photograph(recipe);
  }
};

TEST_F(WithATest, NothingSeesItButTheLastLine) {
  ASSERT_EQ(hookeye("check capture").status, 0);
  const Result found = search("run");
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("test: on press, which no fit, score or stop has seen"));
  const json run = json::parse(read(folder_ / "run/run.json"));
  const double tested = run.at("tested").at("chi"), fitted = run.at("steps").back().at("chi_fit");
  EXPECT_LT(tested, 3.0 * fitted);
  EXPECT_EQ(run.at("tested").at("examples").at(0).at("name"), "press");

  // Its photos may be of anything: every step, score and word but the last stays the same.
  const fs::path photo = folder_ / "capture/photos/press_cam0.png";
  ASSERT_TRUE(fs::exists(photo));
  fs::copy_file(folder_ / "capture/photos/rest_cam0.png", photo,
                fs::copy_options::overwrite_existing);
  ASSERT_EQ(search("other").status, 0);
  const json other = json::parse(read(folder_ / "other/run.json"));
  EXPECT_EQ(other.at("sentence"), run.at("sentence"));
  EXPECT_EQ(other.at("steps").back().at("chi_fit"), run.at("steps").back().at("chi_fit"));
  EXPECT_EQ(other.at("steps").back().at("chi_validate"), run.at("steps").back().at("chi_validate"));
  EXPECT_GT(other.at("tested").at("chi").get<double>(), 2.0 * tested);

  // Of one that has no equilibrium nothing is lost but itself.
  std::string text = read(folder_ / "capture/capture.yaml");
  const size_t force = text.find("force: [", text.find("  press:")), end = text.find(']', force);
  ASSERT_NE(end, std::string::npos);
  write("capture/capture.yaml", text.replace(force, end - force, "force: [0, 0, -1e5"));
  const Result crushed = search("crushed");
  EXPECT_EQ(crushed.status, 0) << crushed.err;
  EXPECT_THAT(crushed.err, HasSubstr("example 'press' of use: test could not be predicted"));
  const json kept = json::parse(read(folder_ / "crushed/run.json"));
  EXPECT_EQ(kept.at("sentence"), run.at("sentence"));
  EXPECT_FALSE(kept.contains("tested"));
}

TEST_F(FittedRun, OptionsAreKeptByTheRunAndOthersAreRefused) {
  const Result listed = hookeye("discover --options");
  EXPECT_EQ(listed.status, 0);
  EXPECT_THAT(listed.out, AllOf(HasSubstr("floor.at = 1.3 times the floor"),
                                HasSubstr("search.worth_a_name"), HasSubstr("fit.huber")));
  const Result unknown = hookeye("fit capture -o other --set floor.att=2");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("floor.at"));
  EXPECT_EQ(hookeye("fit capture -o other --set floor.at=0.5").status, 2);
  EXPECT_EQ(hookeye("fit capture -o other --set floor.at").status, 2);
  EXPECT_FALSE(fs::exists(folder_ / "other"));
  const Result late = hookeye("discover capture -o run --set search.max_effects=0");
  EXPECT_EQ(late.status, 2);  // its base was fitted by others
  EXPECT_THAT(late.err, HasSubstr("name a new folder"));

  // Nothing may be added: the search ends with the base, and says what it would have named.
  const Result none = hookeye("discover capture -o none --set search.max_effects=0");
  ASSERT_EQ(none.status, 0) << none.err;
  const json timeline = json::parse(read(folder_ / "none/run.json"));
  EXPECT_EQ(timeline.at("options"), json({{"search.max_effects", 0.0}}));
  EXPECT_EQ(timeline.at("steps").size(), 1u);
  EXPECT_EQ(hookeye("discover capture -o none").status, 0);  // takes them from the run
}

}  // namespace
}  // namespace hookeye::test
