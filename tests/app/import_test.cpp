// hookeye import from outside.
#include <gmock/gmock.h>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// Two cameras of MatchID, of which the second stands to the right.
constexpr const char* kCalibration =
    "Cam0_Fx [pixels];1200\nCam0_Fy [pixels];1200\nCam0_Cx [pixels];320\nCam0_Cy [pixels];240\n"
    "Cam1_Fx [pixels];1200\nCam1_Fy [pixels];1200\nCam1_Cx [pixels];320\nCam1_Cy [pixels];240\n"
    "Tx [mm];-100\nTy [mm];0\nTz [mm];0\nTheta [deg];0\nPhi [deg];0\nPsi [deg];0\n";

TEST_F(Cli, ImportWritesCamerasThatACaptureTakes) {
  write("a.caldat", kCalibration);
  const Result got = hookeye("import a.caldat -o . --size 640x480");
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("640 x 480"));
  EXPECT_THAT(got.out, HasSubstr("(100, 0, 0)"));
  EXPECT_TRUE(too_long(got.out).empty());
  write_cube("{x: 1}");
  std::string capture = read(folder_ / "capture.yaml");
  capture.insert(capture.find("regions:"), "cameras: {from: cameras.yaml}\n");
  write("capture.yaml", capture);
  const Result checked = hookeye("check . --json");
  ASSERT_EQ(checked.status, 0) << checked.err;
  EXPECT_EQ(json::parse(checked.out)["cameras"].size(), 2u);
  // Again, in other lengths: what import wrote it writes anew.
  const Result again = hookeye("import matchid a.caldat -o . --size 640x480 --scale 0.1 --json");
  ASSERT_EQ(again.status, 0) << again.err;
  const json document = json::parse(again.out);
  EXPECT_EQ(document["kind"], "matchid");
  EXPECT_NEAR(document["cameras"][1]["centre"][0], 10, 1e-12);
}

TEST_F(Cli, ImportWritesNothingWhereAnythingIsWrong) {
  write("a.caldat", kCalibration);
  const auto refused = [&](const std::string& arguments) {
    const Result got = hookeye("import " + arguments);
    EXPECT_EQ(got.status, 2) << arguments << got.out << got.err;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    return got.err;
  };
  EXPECT_THAT(refused("a.caldat -o out"), HasSubstr("--size 1280x1024"));
  EXPECT_THAT(refused("a.caldat -o out --size 640"), HasSubstr("a size like 1280x1024"));
  EXPECT_THAT(refused("dice a.caldat -o out"), HasSubstr("a.caldat: cannot be read"));
  EXPECT_THAT(refused("matchit a.caldat -o out"), HasSubstr("did you mean `matchid`?"));
  EXPECT_THAT(refused("matchid -o out"), HasSubstr("no source behind the kind"));
  EXPECT_THAT(refused("b.caldat -o out"), HasSubstr("b.caldat: there is no such file or folder"));
  write("c.txt", "hello\n");
  EXPECT_THAT(refused("c.txt -o out"), HasSubstr("name the kind before it: colmap"));
  write("cameras.yaml", "cameras: {}\n");
  EXPECT_THAT(refused("a.caldat -o . --size 640x480"), HasSubstr("another file of this name"));
  EXPECT_EQ(read(folder_ / "cameras.yaml"), "cameras: {}\n");
}

}  // namespace
}  // namespace hookeye::test
