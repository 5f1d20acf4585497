// A search that others help: it comes to the same in every bit, with any number of workers, and
// with workers that are killed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <thread>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

class Workers : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write("recipe.yaml", kSmallRecipe);
    const Result made = hookeye("synth recipe.yaml -o capture");
    ASSERT_EQ(made.status, 0) << made.err;
  }
  /// A process that writes what it says into OUT.txt and OUT.err; its number.
  pid_t start(const std::string& arguments, const std::string& out) const {
    const pid_t process = ::fork();
    if (process == 0) {
      const std::string command =
          fmt::format("cd '{}' && exec '{}' {} >{}.txt 2>{}.err </dev/null", folder_.string(),
                      HOOKEYE_PROGRAM, arguments, out, out);
      ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      ::_exit(127);
    }
    return process;
  }
  static int status_of(pid_t process) {
    int status = 0;
    ::waitpid(process, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  /// All that the steps of a run say, but for when and how long it took, and who ordered it.
  std::map<std::string, std::string> results(const std::string& run) const {
    std::map<std::string, std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / run / "steps")) {
      const std::string name = fs::relative(entry.path(), folder_ / run);
      if (entry.is_regular_file() && !name.ends_with("decisions.jsonl") && !name.ends_with(".html"))
        out[name] = read(entry.path());
    }
    json timeline = json::parse(read(folder_ / run / "run.json"));
    for (json& step : timeline.at("steps")) step.erase("command");
    out["run.json"] = timeline.dump(1);
    return out;
  }
  void expect_same(const std::string& run, const std::string& as) const {
    const auto one = results(run), other = results(as);
    for (const auto& [name, text] : other) {
      ASSERT_TRUE(one.contains(name)) << name;
      EXPECT_TRUE(one.at(name) == text) << run << "/" << name << " differs";
    }
    EXPECT_EQ(one.size(), other.size());
    EXPECT_FALSE(fs::exists(folder_ / run / "workers"));
  }
};

TEST_F(Workers, ChangeNoBitOfTheAnswer) {
  ASSERT_EQ(hookeye("discover capture -o alone --threads 1").status, 0)
      << read(folder_ / "err.txt");
  // One that helps, and one that is killed while it does.
  const pid_t helps = start("worker helped --threads 1 --json", "helps"),
              killed = start("worker helped --threads 1", "killed"),
              searches = start("discover capture -o helped --threads 1", "searches");
  for (int i = 0; i < 3000 && (!fs::exists(folder_ / "helped/workers/leased") ||
                               fs::is_empty(folder_ / "helped/workers/leased"));
       ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(killed, SIGKILL);
  EXPECT_EQ(status_of(killed), -1);
  EXPECT_EQ(status_of(searches), 0) << read(folder_ / "searches.err");
  EXPECT_EQ(status_of(helps), 0) << read(folder_ / "helps.err");
  const json said = json::parse(read(folder_ / "helps.txt"));
  EXPECT_GT(said.at("tasks"), 0);
  EXPECT_TRUE(said.at("ended"));
  expect_same("helped", "alone");
  // Those that the search starts itself.
  const Result result = hookeye("discover capture -o two --threads 1 --workers 2");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, testing::Not(HasSubstr("ended with exit status")));
  expect_same("two", "alone");
}

TEST_F(Workers, AreToldWhereThereIsNothingToHelp) {
  const Result none = hookeye("worker nowhere --wait 0.1");
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("no search is at work in this run"));
  EXPECT_FALSE(fs::exists(folder_ / "nowhere"));
  ASSERT_EQ(hookeye("fit capture -o run").status, 0);
  fs::create_directories(folder_ / "run/workers");
  write("run/workers/search.json",
        R"({"id": "a", "worker": "b", "made_for": "xxh3:0", "from": -1, "without": []})");
  const Result other = hookeye("worker run --wait 0.1");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("its search is another program's"));
  write("run/workers/search.json", R"({"id": 1})");
  EXPECT_EQ(hookeye("worker run --wait 0.1").status, 2);
  EXPECT_EQ(hookeye("discover capture -o run --workers 0").status, 2);
}

}  // namespace
}  // namespace hookeye::test
