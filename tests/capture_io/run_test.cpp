#include "capture_io/run.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "capture_io/capture_folder.h"
#include "core/text_file.h"

namespace hookeye::test {
namespace {

namespace fs = std::filesystem;
using RunFolder = hookeye::Run;  // testing::Test has a member of the short name

std::string complaint(const std::function<void()>& action) {
  try {
    action();
    return "";
  } catch (const InputError& error) {
    return error.wrong();
  }
}

void write_model(const fs::path& folder) { write_text(folder / "model.yaml", "mu: 1\n"); }

TEST(RunTest, StepsAreNumberedAndReopened) {
  const TemporaryFolder folder;
  write_text(folder / "capture.yaml", "");
  const fs::path where = folder / "deep/run";
  {
    RunFolder run = RunFolder::create(where, folder / "capture.yaml");
    EXPECT_EQ(run.capture(), folder / "capture.yaml");
    EXPECT_EQ(run.add_step("base", {{"chi_fit", 6.1}}, write_model), where / "steps/00-base");
    run.add_step("gravity", {{"chi_fit", 1.1}}, write_model);
    run.update([](nlohmann::json& timeline) { timeline["verdict"] = "explained"; });
  }
  const RunFolder run = RunFolder::open(where, false);
  ASSERT_EQ(run.steps().size(), 2u);
  EXPECT_EQ(run.steps()[1], where / "steps/01-gravity");
  EXPECT_EQ(read_text(run.steps()[1] / "model.yaml"), "mu: 1\n");
  EXPECT_EQ(run.timeline()["hookeye"], 1);
  EXPECT_EQ(run.timeline()["verdict"], "explained");
  EXPECT_EQ(run.timeline()["steps"][1]["name"], "gravity");
  EXPECT_EQ(run.timeline()["steps"][1]["chi_fit"], 1.1);
}

TEST(RunTest, AChangedCaptureNeedsANewRun) {
  const TemporaryFolder folder;
  write_text(folder / "capture.yaml", "mu: 1\n");
  RunFolder::create(folder / "run", folder / "capture.yaml").add_step("base", {}, write_model);
  write_text(folder / "capture.yaml", "mu: 2\n");
  const auto again = [&] { RunFolder::create(folder / "run", folder / "capture.yaml"); };
  EXPECT_THAT(complaint(again), testing::HasSubstr("this has changed since the run"));
  EXPECT_NE(complaint([&] { RunFolder::open(folder / "run", true); }), "");
  EXPECT_EQ(complaint([&] { RunFolder::open(folder / "run", false); }), "");  // to look at
  write_text(folder / "capture.yaml", "mu: 1\n");
  EXPECT_EQ(complaint(again), "");
}

/// A photo that was swapped, one that is gone, and a bit in the middle of a large one.
TEST(RunTest, AChangedPhotoNeedsANewRun) {
  const TemporaryFolder folder;
  std::string large(5 << 20, 'a');
  write_text(folder / "capture.yaml", "photos: [{front: a.png}, big.tif]\n");
  write_text(folder / "a.png", "one");
  write_text(folder / "big.tif", large);
  RunFolder::create(folder / "run", folder / "capture.yaml").add_step("base", {}, write_model);
  const auto again = [&] { RunFolder::create(folder / "run", folder / "capture.yaml"); };
  EXPECT_EQ(complaint(again), "");
  write_text(folder / "a.png", "two");
  EXPECT_THAT(complaint(again), testing::HasSubstr("this has changed since the run"));
  fs::remove(folder / "a.png");
  EXPECT_THAT(complaint(again), testing::HasSubstr("this has changed since the run"));
  write_text(folder / "a.png", "one");
  EXPECT_EQ(complaint(again), "");
  for (const size_t at : {size_t{0}, large.size() / 3, large.size() - 1}) {
    std::string other = large;
    other[at] ^= 1;
    write_text(folder / "big.tif", other);
    EXPECT_THAT(complaint(again), testing::HasSubstr("this has changed since the run")) << at;
  }
  write_text(folder / "big.tif", large + "a");
  EXPECT_THAT(complaint(again), testing::HasSubstr("this has changed since the run"));
}

/// A run of an older program, which sampled files and had no prefix: it is gone on with, and from
/// then on knows all bytes.
TEST(RunTest, OlderFingerprintsAreNotComparedAndAreReplaced) {
  const TemporaryFolder folder;
  write_text(folder / "capture.yaml", "photos: [a.png]\n");
  write_text(folder / "a.png", "one");
  const auto open = [&] { return RunFolder::create(folder / "run", folder / "capture.yaml"); };
  {
    RunFolder run = open();
    run.add_step("base", {}, write_model);
    run.update([](nlohmann::json& timeline) {
      for (auto& mark : timeline["fingerprints"]) mark = "cbf29ce484222325";
    });
  }
  open().add_step("gravity", {}, write_model);
  write_text(folder / "a.png", "two");
  EXPECT_THAT(complaint(open), testing::HasSubstr("this has changed since the run"));
}

/// Killed before its first step, then the capture was mended.
TEST(RunTest, AStepIsMarkedWithTheCaptureThatItIsMadeFrom) {
  const TemporaryFolder folder;
  write_text(folder / "capture.yaml", "mu: 1\n");
  const auto open = [&] { return RunFolder::create(folder / "run", folder / "capture.yaml"); };
  open().add_step("base", {}, write_model);
  fs::remove_all(folder / "run/steps/00-base");
  auto timeline = nlohmann::json::parse(read_text(folder / "run/run.json"));
  timeline["steps"].clear();
  write_text(folder / "run/run.json", timeline.dump());
  write_text(folder / "capture.yaml", "mu: 2\n");
  open().add_step("base", {}, write_model);
  EXPECT_EQ(complaint(open), "");
}

TEST(RunTest, AFailedStepLeavesNothing) {
  const TemporaryFolder folder;
  RunFolder run = RunFolder::create(folder / "run", folder / "capture.yaml");
  EXPECT_THROW(run.add_step("base", {},
                            [](const fs::path& step) {
                              write_model(step);
                              throw std::runtime_error("stop");
                            }),
               std::runtime_error);
  EXPECT_TRUE(run.steps().empty());
  EXPECT_TRUE(fs::is_empty(folder / "run/steps"));
  run.add_step("base", {}, write_model);
  EXPECT_EQ(run.steps().size(), 1u);
}

TEST(RunTest, ARunWithoutAStepGoes) {
  const TemporaryFolder folder;
  const fs::path capture = folder / "capture.yaml", mine = folder / "mine";
  RunFolder::create(folder / "run", capture);
  EXPECT_FALSE(fs::exists(folder / "run"));
  fs::create_directory(mine);
  RunFolder::create(mine, capture);
  EXPECT_TRUE(fs::is_empty(mine)) << "a folder that was there stays";
  RunFolder::create(mine, capture).add_step("base", {}, write_model);
  RunFolder::create(mine, capture);
  EXPECT_EQ(RunFolder::open(mine, false).steps().size(), 1u);
}

/// A process killed in the middle of a step: the run opens, the half step is gone.
TEST(RunTest, AKillLeavesARunThatResumes) {
  const TemporaryFolder folder;
  const fs::path where = folder / "run", capture = folder / "capture.yaml";
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    RunFolder run = RunFolder::create(where, capture);
    run.add_step("base", {}, write_model);
    run.add_step("gravity", {}, [](const fs::path& step) {
      write_model(step);
      ::raise(SIGKILL);
    });
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(fs::exists(where / "steps/.tmp-01-gravity"));
  EXPECT_EQ(RunFolder::open(where, false).steps().size(), 1u) << "readers see finished steps only";
  RunFolder run = RunFolder::create(where, capture);
  EXPECT_FALSE(fs::exists(where / "steps/.tmp-01-gravity"));
  EXPECT_EQ(run.steps().size(), 1u);
  EXPECT_EQ(run.add_step("swelling", {}, write_model), where / "steps/01-swelling");
}

/// A kill between the renaming of the folder and the writing of run.json.
TEST(RunTest, AStepThatTheTimelineLacksIsReplaced) {
  const TemporaryFolder folder;
  RunFolder run = RunFolder::create(folder / "run", folder / "capture.yaml");
  fs::create_directories(folder / "run/steps/00-orphan");
  run.add_step("base", {}, write_model);
  EXPECT_FALSE(fs::exists(folder / "run/steps/00-orphan"));
  EXPECT_EQ(run.steps().size(), 1u);
}

TEST(RunTest, OneWriterAtATime) {
  const TemporaryFolder folder;
  const fs::path where = folder / "run", capture = folder / "capture.yaml";
  {
    RunFolder first = RunFolder::create(where, capture);
    first.add_step("base", {}, write_model);
    EXPECT_EQ(complaint([&] { RunFolder::create(where, capture); }),
              "another process is writing this run");
    EXPECT_EQ(complaint([&] { RunFolder::open(where, true); }),
              "another process is writing this run");
    EXPECT_EQ(RunFolder::open(where, false).capture(), capture) << "reading needs no lock";
  }
  RunFolder::open(where, true);
}

TEST(RunTest, ForeignFoldersAreRefused) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "photos");
  write_text(folder / "photos/holiday.png", "x");
  EXPECT_EQ(complaint([&] { RunFolder::create(folder / "photos", folder / "c.yaml"); }),
            "the folder holds something else than a run: holiday.png");
  EXPECT_TRUE(fs::exists(folder / "photos/holiday.png"));
  EXPECT_EQ(complaint([&] { RunFolder::create(folder / "photos/holiday.png", folder / "c.yaml"); }),
            "this is a file, not a folder");
  EXPECT_EQ(complaint([&] { RunFolder::open(folder / "photos", false); }),
            "there is no run in this folder");
  RunFolder::create(folder / "run", folder / "c.yaml").add_step("base", {}, write_model);
  write_text(folder / "capture.yaml", "");
  EXPECT_EQ(RunFolder::create(folder / "by_folder", folder.path()).capture(),
            folder / "capture.yaml");
  EXPECT_EQ(complaint([&] { RunFolder::create(folder / "run", folder / "d.yaml"); }),
            "the folder holds a run of another capture: " + (folder / "c.yaml").string());
}

TEST(RunTest, BrokenTimelinesAreRefused) {
  const TemporaryFolder folder;
  for (const char* text : {"", "{", "[]", "{\"hookeye\": 2}", "{\"hookeye\": 1, \"capture\": 3}"}) {
    write_text(folder / "run.json", text);
    EXPECT_NE(complaint([&] { RunFolder::open(folder.path(), false); }), "") << text;
  }
}

TEST(RunTest, FilesOfAStepAreNeverChanged) {
  const TemporaryFolder folder;
  RunFolder run = RunFolder::create(folder / "run", folder / "capture.yaml");
  const fs::path step = run.add_step("base", {}, write_model);
  const auto writer = [](const char* text) {
    return [=](const fs::path& file) { write_text(file, text); };
  };
  run.add_file(step, "diagnosis.json", writer("{}"));
  run.add_file(step, "diagnosis.json", writer("{}"));
  EXPECT_EQ(complaint([&] { run.add_file(step, "diagnosis.json", writer("[]")); }),
            "the step already has this file with other content");
  EXPECT_EQ(read_text(step / "diagnosis.json"), "{}");
  run.add_file(step, "diagnosis.json", writer("[]"), true);
  EXPECT_EQ(read_text(step / "diagnosis.json"), "[]");
  run.add_file(step, "pictures", [](const fs::path& f) {
    fs::create_directories(f);
    write_text(f / "a.txt", "a");
  });
  EXPECT_EQ(read_text(step / "pictures/a.txt"), "a");
  size_t entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(step)) ++entries;
  EXPECT_EQ(entries, 3u) << "no temporary file is left";
}

TEST(RunTest, AFolderThatIsRemovedMeanwhileDoesNotComeBack) {
  const TemporaryFolder folder;
  const fs::path where = folder / "run";
  RunFolder run = RunFolder::create(where, folder / "capture.yaml");
  const fs::path step = run.add_step("base", {}, write_model);
  fs::remove_all(where);
  const auto write = [](const fs::path& file) { write_text(file, "{}"); };
  const std::function<void()> ways[] = {
      [&] { run.add_step("gravity", {}, write_model); },
      [&] { run.add_file(step, "diagnosis.json", write); },
      [&] { run.update([](nlohmann::json& timeline) { timeline["verdict"] = "explained"; }); }};
  for (const auto& way : ways)
    EXPECT_EQ(complaint(way), "the run folder was removed or moved while it was written");
  EXPECT_FALSE(fs::exists(where));
  // Nor does another run in its place get a step of this one.
  const RunFolder other = RunFolder::create(where, folder / "capture.yaml");
  EXPECT_NE(complaint(ways[0]), "");
  EXPECT_TRUE(fs::is_empty(where / "steps"));
}

TEST(RunTest, AFolderThatIsRemovedWhileAStepIsWrittenIsToldAsThat) {
  const TemporaryFolder folder;
  const fs::path where = folder / "run";
  RunFolder run = RunFolder::create(where, folder / "capture.yaml");
  const auto remove_and_write = [&](const fs::path& temporary) {
    fs::remove_all(where);
    write_model(temporary);
  };
  EXPECT_EQ(complaint([&] { run.add_step("base", {}, remove_and_write); }),
            "the run folder was removed or moved while it was written");
}

TEST(RunTest, ReadersCannotWrite) {
  const TemporaryFolder folder;
  RunFolder::create(folder / "run", folder / "capture.yaml").add_step("base", {}, write_model);
  RunFolder run = RunFolder::open(folder / "run", false);
  EXPECT_THROW(run.add_step("base", {}, write_model), std::logic_error);
}

}  // namespace
}  // namespace hookeye::test
