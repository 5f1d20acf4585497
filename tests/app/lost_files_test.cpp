// What is taken from under a run: a photo that goes or changes, and the room on its disk.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using ::testing::HasSubstr;

/// Runs a script in the test's folder; its exit status.
int run_script(const fs::path& folder, const std::string& script, const std::string& by = "sh") {
  std::ofstream(folder / "script.sh") << "cd '" << folder.string() << "'\n" << script;
  const int status = std::system(fmt::format("{} '{}/script.sh'", by, folder.string()).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Bytes by name of all files below a folder.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      out[fs::relative(entry.path(), folder).string()] = read(entry.path());
  return out;
}

/// Names that are of no finished file.
std::vector<std::string> half_written(const fs::path& folder) {
  std::vector<std::string> out;
  for (const auto& [name, bytes] : files_of(folder))
    if (name.find(".tmp-") != std::string::npos) out.push_back(name);
  return out;
}

class PhotoTaken : public WithSmallCapture {
 protected:
  void SetUp() override {
    WithSmallCapture::SetUp();
    fs::copy_file(photo(), folder_ / "kept.png");
  }
  fs::path photo() const { return folder_ / "capture/photos/push_cam0.png"; }

  /// Exit status of a fit that reads its photos in part; `then` is done once it has read them.
  int fit(const std::string& then) const {
    return run_script(
        folder_, fmt::format("'{}' fit capture -o run --set fit.pixels=2000 >out.txt 2>err.txt "
                             "</dev/null & program=$!\n"
                             "while kill -0 $program && [ ! -e run/run.json ]; do sleep 0.005; done"
                             " 2>/dev/null\n{}\nwait $program\n",
                             HOOKEYE_PROGRAM, then));
  }
  /// The fit ends with the photo's name, keeps what had ended, and goes on once the photo is back.
  void expect_named() {
    EXPECT_THAT(read(folder_ / "err.txt"), HasSubstr("push_cam0.png"));
    ASSERT_TRUE(fs::exists(folder_ / "run/steps/00-base/model.yaml"));
    EXPECT_THAT(half_written(folder_ / "run"), testing::IsEmpty());
    EXPECT_FALSE(json::parse(read(folder_ / "run/run.json")).at("steps")[0].contains("all_pixels"));
    fs::copy_file(folder_ / "kept.png", photo(), fs::copy_options::overwrite_existing);
    const Result again = hookeye("fit capture -o run");
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_TRUE(json::parse(read(folder_ / "run/run.json")).at("steps")[0].contains("all_pixels"));
  }
};

TEST_F(PhotoTaken, OneThatGoesWhileARunGoesOnIsNamed) {
  EXPECT_EQ(fit("rm " + photo().string()), 2) << read(folder_ / "err.txt");
  expect_named();
}

TEST_F(PhotoTaken, OneThatChangesWhileARunGoesOnIsNamed) {
  EXPECT_EQ(fit("cp capture/photos/pull_cam0.png " + photo().string()), 2)
      << read(folder_ / "err.txt");
  EXPECT_THAT(read(folder_ / "err.txt"), HasSubstr("has changed since it was read"));
  expect_named();
}

class FullDisk : public FittedRun {
 protected:
  void SetUp() override {
    if (std::system("unshare -m mount -t tmpfs none /mnt 2>/dev/null") != 0)
      GTEST_SKIP() << "NOT RUN: no file system may be mounted here (it needs root), so a full disk "
                      "was not tried";
    FittedRun::SetUp();
    fs::create_directory(folder_ / "room");
  }
};

TEST_F(FullDisk, FinishedStepsStayAndTheCommandGoesOnOnceThereIsRoom) {
  const auto before = files_of(folder_ / "run/steps");
  const std::string command = fmt::format("'{}' diagnose room/run", HOOKEYE_PROGRAM);
  ASSERT_EQ(run_script(folder_,
                       fmt::format("mount -t tmpfs -o size=64m none room || exit 9\n"
                                   "cp -a run room/run\n"
                                   "used=$(df -k --output=used room | tail -n 1)\n"
                                   "mount -o remount,size=$((used + 24))k room || exit 9\n"
                                   "{0} >out.txt 2>err.txt; echo $? >status\n"
                                   "cp -a room/run full\n"
                                   "mount -o remount,size=64m room || exit 9\n"
                                   "{0} >out2.txt 2>err2.txt; echo $? >again\n"
                                   "cp -a room/run whole\n",
                                   command),
                       "unshare -m sh"),
            0);
  const std::string complaint = read(folder_ / "err.txt");
  EXPECT_EQ(read(folder_ / "status"), "2\n") << complaint;
  EXPECT_THAT(complaint, HasSubstr("room/run"));
  EXPECT_THAT(complaint, HasSubstr("No space left on device"));
  EXPECT_THAT(half_written(folder_ / "full"), testing::IsEmpty());
  const auto after = files_of(folder_ / "full/steps");
  for (const auto& [name, bytes] : before) {
    ASSERT_TRUE(after.count(name)) << name;
    EXPECT_TRUE(after.at(name) == bytes) << name << " has changed";
  }
  EXPECT_EQ(read(folder_ / "again"), "0\n") << read(folder_ / "err2.txt");
  EXPECT_TRUE(fs::exists(folder_ / "whole/steps/00-base/diagnosis.json"));
}

}  // namespace
}  // namespace hookeye::test
