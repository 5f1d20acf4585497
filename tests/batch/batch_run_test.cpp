// `hookeye batch` from outside: what it does, shares, refuses, and what survives when it is killed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <map>
#include <random>
#include <thread>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class Batch : public Cli {
 protected:
  /// Captures c0, c1, ... of cubes that are pulled, each by another length.
  void write_captures(int count) const {
    for (int i = 0; i < count; ++i) {
      write_cube(fmt::format("{{z: {}}}", 0.5 + 0.01 * i));
      const fs::path to = folder_ / "all" / fmt::format("c{}", i);
      fs::create_directories(to);
      for (const char* name : {"cube.obj", "capture.yaml"}) fs::rename(folder_ / name, to / name);
    }
  }
  std::vector<std::string> files(const std::string& name) const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder_ / "out" / name))
      out.push_back(entry.path().filename());
    std::sort(out.begin(), out.end());
    return out;
  }
  json rows() const {
    return json::parse(hookeye("batch --resume out --status --json").out).at("captures");
  }
};

const std::string kProgram = "'" HOOKEYE_PROGRAM "' ";
const std::string kCheck = "batch all -o out --verb check --jobs 2 --threads 1";

TEST_F(Batch, FailuresAreCollectedAndNothingIsDoneTwice) {
  write_captures(4);
  write("all/c2/cube.obj", "v 0 0 0\nf 1 1 1\n");
  const Result first = hookeye(kCheck);
  EXPECT_EQ(first.status, 3) << first.err;
  EXPECT_THAT(first.out, HasSubstr("4 captures: 3 done, 1 failed"));
  EXPECT_THAT(first.out, HasSubstr("failed: c2: exit status 2: "));
  EXPECT_THAT(first.err, HasSubstr("c2/capture.yaml:5:12: the surface has no triangle"));
  EXPECT_TRUE(fs::exists(folder_ / "out/index.html"));
  EXPECT_THAT(read(folder_ / "out/index.csv"), HasSubstr("c2,"));
  const auto done = files("done"), results = files("results");
  const auto written = fs::last_write_time(folder_ / "out/results" / results[0]);
  const json row = rows().at(0);
  EXPECT_EQ(row.at("label"), "c0");
  EXPECT_EQ(row.at("exit"), 0);
  EXPECT_GT(row.at("memory"), 1e6);
  EXPECT_GT(row.at("cpu_seconds"), 0.0);

  const Result again = hookeye(kCheck);
  EXPECT_EQ(again.status, 3);
  EXPECT_EQ(files("done"), done);
  EXPECT_EQ(files("results"), results);
  EXPECT_EQ(fs::last_write_time(folder_ / "out/results" / results[0]), written);

  // One that was mended is another capture; the old one counts no more.
  fs::copy_file(folder_ / "all/c1/cube.obj", folder_ / "all/c2/cube.obj",
                fs::copy_options::overwrite_existing);
  const Result mended = hookeye(kCheck + " --json");
  EXPECT_EQ(mended.status, 0) << mended.err;
  const json document = json::parse(mended.out);
  EXPECT_EQ(document.at("counts").at("done"), 4);
  EXPECT_EQ(document.at("counts").at("failed"), 0);
  EXPECT_THAT(files("done"), SizeIs(4));
  for (const std::string& one : done) EXPECT_TRUE(fs::exists(folder_ / "out/done" / one));
}

TEST_F(Batch, WhatIsNotTheSameIsRefused) {
  write_captures(1);
  ASSERT_EQ(hookeye(kCheck).status, 0);
  const std::pair<std::string, std::string> refused[] = {
      {"batch all -o out --verb simulate", "worked on by `check`, not by `simulate`"},
      {"batch all -o out --verb check -- --quick", "it was begun without options of the verb"},
      {"batch all -o new --verb check -- --quik", "`--quik` is no option of `hookeye check`"},
      {"batch all -o new --verb check -- -o there", "`-o` is no option of `hookeye check`"},
      {"batch all -o all/c0", "something else than a batch: "},
      {"batch nowhere -o new", "there is no "},
      {"batch --resume all", "there is no batch in this folder"},
      {"batch all", "requires"},
      {"batch", "CAPTURES with -o, or --resume"},
      {"batch all -o new --jobs 0", "a whole number from 1"},
      {"batch all -o new --verb studio", "studio"}};
  for (const auto& [command, said] : refused) {
    const Result result = hookeye(command);
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_THAT(result.err, HasSubstr(said)) << command;
    EXPECT_FALSE(fs::exists(folder_ / "new")) << command;
  }
}

TEST_F(Batch, ATableHasItsOptionsARow) {
  write_captures(2);
  write("list.csv", "capture,name,quick\nall/c0,slow,no\nall/c0,fast,yes\nall/c1,other,\n");
  const Result made = hookeye("batch list.csv -o out --verb check --jobs 2 --json");
  ASSERT_EQ(made.status, 0) << made.err;
  const json captures = json::parse(made.out).at("captures");
  ASSERT_THAT(captures, SizeIs(3));
  EXPECT_EQ(captures[0].at("label"), "slow");
  EXPECT_EQ(captures[1].at("options"), json({"--quick"}));
  EXPECT_NE(captures[0].at("key"), captures[1].at("key"));
}

TEST_F(Batch, WhatTakesTooLongIsEnded) {
  write_captures(1);
  const Result result = hookeye(kCheck + " --timeout 0.001");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.out, HasSubstr("it took longer than 0.001 s (--timeout)"));
  EXPECT_EQ(hookeye(kCheck).status, 3) << "failures are not tried again unasked";
  EXPECT_EQ(hookeye(kCheck + " --retry").status, 0);
}

/// A program in the background, in a group of its own.
class Background {
 public:
  Background(const fs::path& folder, const std::string& command) : process_(::fork()) {
    if (process_ != 0) return;
    ::setpgid(0, 0);
    const std::string line =
        fmt::format("cd '{}' && exec {} >>out.txt 2>>err.txt </dev/null", folder.string(), command);
    ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    ::_exit(127);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() { end(SIGKILL); }
  int end(int signal) {
    if (process_ <= 0) return 0;
    if (signal) ::kill(process_, signal);
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t process_;
};

/// Processes of this user whose command line names the folder.
int at_work_in(const fs::path& folder) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string line = read(entry.path() / "cmdline");
    count += line.find((folder / "out").string()) != std::string::npos;
  }
  return count;
}

TEST_F(Batch, KilledAtAnyMomentItLosesNothingAndRepeatsOnlyWhatWasRunning) {
  constexpr int kCaptures = 24;
  write_captures(kCaptures);
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::map<std::string, fs::file_time_type> done;
  for (const int signal : {SIGKILL, SIGINT, SIGKILL, SIGKILL}) {
    Background one(folder_, kProgram + kCheck), two(folder_, kProgram + kCheck);
    std::this_thread::sleep_for(
        std::chrono::milliseconds(std::uniform_int_distribution(50, 900)(random)));
    one.end(signal);
    const int status = two.end(signal);
    EXPECT_TRUE(signal == SIGKILL || status == 130 || status == 0) << status;
    for (int i = 0; i < 100 && at_work_in(folder_) > 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(at_work_in(folder_), 0) << "a process has outlived its batch";
    if (!fs::exists(folder_ / "out/done")) continue;
    for (const auto& [name, time] : done)
      EXPECT_EQ(fs::last_write_time(folder_ / "out/results" / name), time)
          << "done twice: " << name;
    for (const std::string& name : files("done"))
      done[name] = fs::last_write_time(folder_ / "out/results" / name);
  }
  const Result last = hookeye(kCheck);
  EXPECT_EQ(last.status, 0) << last.err << read(folder_ / "err.txt");
  EXPECT_THAT(files("done"), SizeIs(kCaptures));
  for (const auto& [name, time] : done)
    EXPECT_EQ(fs::last_write_time(folder_ / "out/results" / name), time) << name;
  for (const char* folder : {"todo", "leased", "failed", "new"})
    EXPECT_THAT(files(folder), SizeIs(0));
}

/// Two enrol a capture at once; the second is killed, and nobody can tell yet that it has gone.
TEST_F(Batch, WhatSomebodyElseEnrolledFirstIsNotLeftLyingAbout) {
  write_captures(1);
  ASSERT_EQ(hookeye(kCheck).status, 0);
  const auto tasks = files("tasks");
  ASSERT_THAT(tasks, SizeIs(1));
  write("out/new/" + *tasks.begin() + ".0@elsewhere-17-1a2b3c4d",
        read(folder_ / "out/tasks" / *tasks.begin()));
  EXPECT_EQ(hookeye(kCheck).status, 0);
  EXPECT_THAT(files("new"), SizeIs(0));
}

TEST_F(Batch, AKilledCaptureIsBegunAgain) {
  write_captures(1);
  write("wait.sh", R"(for i in $(seq 200); do
  child=$(pgrep -f "check $PWD/all/c0/capture.yaml")
  if [ -n "$child" ]; then kill -9 $child; exit; fi
  sleep 0.01
done
)");
  Background killer(folder_, "sh wait.sh");
  const Result result = hookeye(kCheck);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(files("done"), SizeIs(1));
}

}  // namespace
}  // namespace hookeye::test
