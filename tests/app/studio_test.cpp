// The studio from outside: what it answers, and what it tells of a refit.
#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "app/fitted_run.h"
#include "app/served.h"

namespace hookeye::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// `hookeye studio run`, ended with the object.
struct Studio : Served {
  explicit Studio(const fs::path& folder) : Served(folder, "studio", "run") {}
};

TEST_F(Cli, AStudioForAllAddressesIsRefused) {
  for (const std::string host : {"0.0.0.0", "0", "::", "::ffff:0.0.0.0", "''"}) {
    const Result result = hookeye("studio . --host " + host);
    EXPECT_EQ(result.status, 2) << host;
    EXPECT_THAT(result.err, HasSubstr("all addresses of the machine")) << host;
    EXPECT_EQ(result.out, "") << host;
  }
}

/// Requests that cannot be are answered with what is wrong, before anything starts.
TEST_F(Cli, TheStudioSaysWhatIsWrongWithARequest) {
  write_cube("{z: 1}");
  fs::create_directories(folder_ / "run/steps/00-base");
  json timeline = {
      {"hookeye", 1},
      {"capture", (folder_ / "capture.yaml").string()},
      {"steps",
       {{{"name", "base"}, {"added", nullptr}, {"effects", {"swelling"}}, {"chi_fit", 2.0}}}}};
  write("run/run.json", timeline.dump());
  const Studio studio(folder_);
  if (!studio.ready() && hookeye("studio run").err.find("without its page") != std::string::npos)
    GTEST_SKIP() << "built without the page";
  ASSERT_TRUE(studio.ready());
  const auto type = studio.post("add", R"({"effect": "gravity", "take_back": "x"})");
  EXPECT_EQ(type.status, 400);
  EXPECT_EQ(type.body, "take_back is true or false, not \"x\"");
  const auto other = studio.post("add", R"({"effect": "gravity", "take_back": true})");
  EXPECT_EQ(other.status, 409);
  EXPECT_THAT(other.body, HasSubstr("it has swelling"));
  const auto again = studio.post("add", R"({"effect": "swelling"})");
  EXPECT_EQ(again.status, 409);
  EXPECT_THAT(again.body, HasSubstr("the newest step has this effect already"));
  EXPECT_EQ(studio.post("add", R"({"effect": "gravvity"})").status, 400);
  EXPECT_EQ(studio.post("add", "{").status, 400);
  EXPECT_EQ(json::parse(studio.get("job").body).at("state"), "idle");
}

/// A thread that a library started when it was loaded ended the program by it.
TEST_F(Cli, CtrlCEndsTheStudioWhateverThreadsLibrariesStarted) {
  write_cube("{z: 1}");
  fs::create_directories(folder_ / "run/steps/00-base");
  const json timeline = {{"hookeye", 1},
                         {"capture", (folder_ / "capture.yaml").string()},
                         {"steps", {{{"name", "base"}, {"added", nullptr}, {"chi_fit", 2.0}}}}};
  write("run/run.json", timeline.dump());
  Studio studio(folder_);
  if (!studio.ready() && hookeye("studio run").err.find("without its page") != std::string::npos)
    GTEST_SKIP() << "built without the page";
  ASSERT_TRUE(studio.ready());
  int threads = 0, open = 0;
  for (const auto& thread :
       fs::directory_iterator("/proc/" + std::to_string(studio.process()) + "/task")) {
    const std::string status = read(thread.path() / "status"), key = "SigBlk:";
    const auto blocked = std::stoull(status.substr(status.find(key) + key.size()), nullptr, 16);
    const uint64_t ctrl_c = uint64_t{1} << (SIGINT - 1);
    threads += 1, open += (blocked & ctrl_c) == 0;
  }
  EXPECT_GT(threads, 2);
  EXPECT_EQ(open, 1) << "the one that waits for it";
  const int status = studio.interrupt();
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

/// A run whose parts are links to what lies outside it: no route reads or writes through them.
TEST_F(Cli, NoRouteOfTheStudioFollowsALinkOutOfTheRun) {
  write_cube("{z: 1}");
  const fs::path run = folder_ / "run", base = run / "steps/00-base", out = folder_ / "outside";
  for (const char* sub : {"page", "removed", "deformed", "residuals"})
    fs::create_directories(base / sub);
  fs::create_directories(out / "page");
  for (const char* name : {"metrics.json", "page/body.json", "model.yaml", "a.vtu", "a.exr"})
    write((fs::path("outside") / name).string(), R"({"secret": "SECRET"})");
  const json timeline = {{"hookeye", 1},
                         {"capture", (folder_ / "capture.yaml").string()},
                         {"steps", {{{"name", "base"}, {"effects", json::array()}}}}};
  write("run/run.json", timeline.dump());
  fs::create_symlink(out / "metrics.json", base / "metrics.json");
  fs::create_symlink(out / "metrics.json", base / "diagnosis.json");
  fs::create_symlink(out / "page/body.json", base / "page/body.json");
  fs::create_symlink(out / "page/body.json", base / "removed/gravity.json");
  fs::create_symlink("../../../../outside/a.vtu", base / "deformed/a.vtu");
  fs::create_symlink(out / "a.exr", base / "residuals/a.exr");
  fs::create_symlink(out / "model.yaml", base / "model.yaml");
  fs::create_symlink(out, run / "steps/01-out");
  write("run/steps/00-base/own.json", "{}");
  fs::create_symlink("own.json", base / "inner.json");
  const Studio studio(folder_);
  if (!studio.ready() && hookeye("studio run").err.find("without its page") != std::string::npos)
    GTEST_SKIP() << "built without the page";
  ASSERT_TRUE(studio.ready());
  for (const char* whole : {"", "document", "job"}) {
    const auto answer = studio.get(whole);
    EXPECT_EQ(answer.status, 200) << whole;
    EXPECT_THAT(answer.body, Not(HasSubstr("SECRET"))) << whole;
    EXPECT_THAT(answer.body, Not(HasSubstr("01-out"))) << whole;
  }
  EXPECT_THAT(studio.get("document").body,
              HasSubstr("00-base/metrics.json is a link out of this run"));
  for (const std::string part :
       {"field/00-base/body.json", "field/00-base/removes-gravity.json", "deformed/00-base/a.vtu",
        "residual/00-base/a", "field/01-out/body.json", "deformed/01-out/a.vtu",
        "residual/01-out/a"})
    EXPECT_EQ(studio.get("part?name=" + part).status, 404) << part;
  for (const std::string file :
       {"steps/00-base/metrics.json", "steps/00-base/model.yaml", "steps/00-base/deformed/a.vtu",
        "steps/00-base/residuals/a.exr", "steps/01-out/metrics.json", "steps/01-out/page/body.json",
        "../outside/metrics.json", "../capture.yaml"})
    EXPECT_EQ(studio.get("file?name=" + file).status, 404) << file;
  EXPECT_EQ(studio.get("file?name=steps/00-base/inner.json").body, "{}");
  const auto add = studio.post("add", R"({"effect": "gravity"})");
  EXPECT_EQ(add.status, 409);
  EXPECT_THAT(add.body, HasSubstr("is a link out of this run"));
  EXPECT_EQ(json::parse(studio.post("stop", "{}").body).at("state"), "idle");
  // Nor does a report hold what lies outside.
  ASSERT_EQ(hookeye("report run -o report.html").status, 0);
  EXPECT_THAT(read(folder_ / "report.html"), Not(HasSubstr("SECRET")));
}

TEST_F(Cli, ARunThatIsALinkAndItsLockAreNotFollowed) {
  write_cube("{z: 1}");
  fs::create_directories(folder_ / "run/steps/00-base");
  write("outside.json", R"({"hookeye": 1, "steps": [], "secret": "SECRET"})");
  write("mine.txt", "mine");
  fs::create_symlink("../outside.json", folder_ / "run/run.json");
  fs::create_symlink("../mine.txt", folder_ / "run/.studio");
  {
    const Studio studio(folder_);
    if (!studio.ready() && hookeye("studio run").err.find("without its page") != std::string::npos)
      GTEST_SKIP() << "built without the page";
    ASSERT_TRUE(studio.ready());
    EXPECT_THAT(studio.get("document").body, Not(HasSubstr("SECRET")));
    EXPECT_EQ(studio.get("file?name=run.json").status, 404);
  }
  EXPECT_EQ(read(folder_ / "mine.txt"), "mine");
}

TEST_F(FittedRun, TheStudioTellsWhatARefitIsDoing) {
  ASSERT_EQ(hookeye("diagnose run").status, 0);
  const Studio studio(folder_);
  if (!studio.ready() && hookeye("studio run").err.find("without its page") != std::string::npos)
    GTEST_SKIP() << "built without the page";
  ASSERT_TRUE(studio.ready());
  ASSERT_EQ(studio.post("add", R"({"effect": "gravity"})").status, 200);
  std::vector<std::string> stages;
  json now;
  for (int i = 0; i < 6000; ++i) {
    now = json::parse(studio.get("job").body);
    const std::string stage = now.value("stage", "");
    if (stages.empty() || stages.back() != stage) stages.push_back(stage);
    if (now.at("state") != "running") break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ASSERT_EQ(now.at("state"), "done") << now.dump();
  // The diagnosis on disk is used, and the pictures of the old step are not the end of a fit.
  EXPECT_THAT(stages, Not(Contains("diagnosing the newest step")));
  const auto first = [&](const std::string& begin) {
    return std::find_if(stages.begin(), stages.end(),
                        [&](const std::string& stage) { return stage.rfind(begin, 0) == 0; });
  };
  EXPECT_NE(first("refitting, "), stages.end());
  EXPECT_LE(first("refitting"), first("computing the final"));
  EXPECT_EQ(timeline().at("steps").size(), 2U);
}

}  // namespace
}  // namespace hookeye::test
