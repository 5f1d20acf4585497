// One search by several processes: whoever works out what, and whoever is killed at it, the answer
// is the same in every bit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <map>
#include <random>
#include <thread>

#include "app/cli.h"

namespace hookeye::test {
namespace {

/// Races, refits, wider forms, a finer mesh and exchanges, in ten seconds.
constexpr const char* kRecipe = R"(hookeye_recipe: 1
title: small
seed: 3
body: {shape: block, size: [20, 20, 40], mesh: {edge: 14, order: 1}, density: 1.07e-9}
material: {law: neo-hookean, true: {mu: 0.05, kappa_over_mu: 12}, told: {mu: 0.042}, fit: [mu]}
cameras: {count: 1, size: [72, 72], focal: 240}
examples:
  rest: {}
  pull: {force: [0, 0, 0.4]}
  push: {use: validate, force: [0.1, 0, 0]}
hidden:
  - {effect: gravity, values: {gravity.x: 3000, gravity.z: -9650}}
)";
constexpr const char* kSearch =
    "discover capture --without stiffness_field --without strain_stiffening --without placement "
    "--without camera_pose -o ";

/// A program in the background, ended where it runs on.
class Background {
 public:
  /// `words` in the shell of `folder`, from where `log` is named.
  Background(const fs::path& folder, const std::string& words, const std::string& log) {
    const std::string line = fmt::format("cd '{}' && exec '{}' {} >{} 2>&1 </dev/null",
                                         folder.string(), HOOKEYE_PROGRAM, words, log);
    process_ = ::fork();
    if (process_ != 0) return;
    ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    ::_exit(127);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() { kill(), end(); }
  void kill() const {
    if (process_ > 0) ::kill(process_, SIGKILL);
  }
  /// Exit status, 128 + signal where one ended it.
  int end() {
    int status = 0;
    if (process_ <= 0) return -1;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  bool runs() {
    int status = 0;
    if (process_ <= 0 || ::waitpid(process_, &status, WNOHANG) == 0) return process_ > 0;
    process_ = -1;
    return false;
  }

 private:
  pid_t process_ = -1;
};

/// Without what tells of time and of the command line.
std::string without_costs(const fs::path& file) {
  if (file.filename() == "decisions.jsonl") {
    std::string out;
    std::istringstream lines(read(file));
    for (std::string line; std::getline(lines, line);) {
      json told = json::parse(line);
      told.erase("cpu_s");
      out += told.dump() + "\n";
    }
    return out;
  }
  json told = json::parse(read(file));
  for (json& step : told.at("steps")) {
    step.erase("command");
    step.erase("versions");
  }
  return told.dump();
}

/// What a run says, by file.
std::map<std::string, std::string> said_by(const fs::path& run) {
  std::map<std::string, std::string> out = {{"run.json", without_costs(run / "run.json")}};
  for (const auto& step : fs::directory_iterator(run / "steps"))
    for (const char* name : {"model.yaml", "metrics.json", "diagnosis.json", "parameters.csv"})
      out[step.path().filename().string() + "/" + name] = read(step.path() / name);
  for (const auto& step : fs::directory_iterator(run / "steps"))
    out[step.path().filename().string() + "/decisions"] =
        without_costs(step.path() / "decisions.jsonl");
  return out;
}

class Workers : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    photograph(kRecipe);
  }
  void expect_same(const std::string& run, const std::string& reference) const {
    const auto said = said_by(folder_ / run), was = said_by(folder_ / reference);
    ASSERT_EQ(said.size(), was.size());
    for (const auto& [name, text] : was) EXPECT_TRUE(said.at(name) == text) << run << ": " << name;
    EXPECT_FALSE(fs::exists(folder_ / run / "workers")) << "nothing is left of them";
  }
  int answers_in(const std::string& log) const {
    const std::string told = read(folder_ / log);
    const size_t at = told.find("worked out ");
    return at == std::string::npos ? -1 : std::atoi(told.c_str() + at + 11);
  }
};

TEST_F(Workers, AnyNumberComesToTheSameBits) {
  const Result alone = hookeye(std::string(kSearch) + "alone --threads 2");
  ASSERT_EQ(alone.status, 0) << alone.err;
  ASSERT_FALSE(fs::exists(folder_ / "alone/workers"));
  ASSERT_GE(said_by(folder_ / "alone").size(), 11U) << "steps were added";

  {
    // A worker that waits for the search to begin.
    Background early(folder_, "worker one", "early.txt");
    const Result one = hookeye(std::string(kSearch) + "one --threads 1");
    ASSERT_EQ(one.status, 0) << one.err;
    EXPECT_EQ(early.end(), 0) << read(folder_ / "early.txt");
    EXPECT_GT(answers_in("early.txt"), 3) << read(folder_ / "early.txt");
  }
  expect_same("one", "alone");
  const Result profile = hookeye("profile one");
  EXPECT_THAT(profile.out, testing::HasSubstr("a worker")) << profile.err;

  const Result five = hookeye(std::string(kSearch) + "five --workers 5");
  ASSERT_EQ(five.status, 0) << five.err;
  EXPECT_THAT(five.err, testing::HasSubstr("workers: 5 beside this process"));
  expect_same("five", "alone");

  // Two that are killed now and then, and the search itself once.
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto pause = [&] {
    const double seconds = std::uniform_real_distribution(0.3, 2.0)(random);
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  };
  const auto search = [&] {
    return std::make_unique<Background>(folder_, std::string(kSearch) + "two", "two.txt");
  };
  const auto worker = [&] {
    return std::make_unique<Background>(folder_, "worker two --wait 30", "worker.txt");
  };
  auto master = search(), first = worker(), second = worker();
  for (int turn = 0; turn < 4 && master->runs(); ++turn) {
    pause();
    (turn % 2 ? second : first)->kill();
    if (turn == 1) {
      master->kill();
      EXPECT_EQ(master->end(), 128 + SIGKILL);
      master = search();
    }
    (turn % 2 ? second : first) = worker();
  }
  EXPECT_EQ(master->end(), 0) << read(folder_ / "two.txt");
  EXPECT_EQ(first->end(), 0) << read(folder_ / "worker.txt");
  EXPECT_EQ(second->end(), 0) << read(folder_ / "worker.txt");
  expect_same("two", "alone");
}

TEST_F(Workers, AStrangerIsTurnedAway) {
  const Result nobody = hookeye("worker nowhere --wait 0");
  EXPECT_EQ(nobody.status, 0) << nobody.err;
  EXPECT_THAT(nobody.out, testing::HasSubstr("no search was at work there"));

  Background search(folder_, std::string(kSearch) + "run --threads 1", "search.txt");
  const fs::path notice = folder_ / "run/workers/search.json";
  for (int i = 0; i < 1000 && !fs::exists(notice); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_TRUE(fs::exists(notice)) << read(folder_ / "search.txt");
  const std::string told = read(notice);

  json other = json::parse(told);
  other["program"] = "xxh3:of another program";
  other["version"] = "0.0.1";
  write("run/workers/search.json", other.dump());
  const Result stranger = hookeye("worker run");
  EXPECT_EQ(stranger.status, 2);
  EXPECT_THAT(stranger.err, testing::HasSubstr("run by another program, 0.0.1"));

  // A machine that sees other files under the same path.
  write("run/workers/search.json", told);
  const std::string yaml = read(folder_ / "capture/capture.yaml");
  write("capture/capture.yaml", yaml + "# changed\n");
  const Result differs = hookeye("worker run");
  EXPECT_EQ(differs.status, 2);
  EXPECT_THAT(differs.err, testing::HasSubstr("differs from what the search in"));
}

}  // namespace
}  // namespace hookeye::test
