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

class RefusedImport : public Cli {
 protected:
  std::string refused(const std::string& arguments) const {
    const Result got = hookeye("import " + arguments);
    EXPECT_EQ(got.status, 2) << arguments << got.out << got.err;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    return got.err;
  }
};

TEST_F(RefusedImport, WritesNothingWhereAnythingIsWrong) {
  write("a.caldat", kCalibration);
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

TEST_F(RefusedImport, OrPhotosOfVideos) {
  write("a.caldat", kCalibration);
  EXPECT_THAT(refused("a.caldat -o out --size 640x480 --every 2"), HasSubstr("are of videos"));
  EXPECT_THAT(refused("no.mp4 -o out"), HasSubstr("no.mp4: there is no such file"));
  EXPECT_THAT(refused("video -o out"), HasSubstr("there is no source behind the kind"));
  write("junk.mp4", "no video at all");
  EXPECT_THAT(refused("junk.mp4 -o out --size 640x480"), HasSubstr("are of cameras"));
  if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) {
    EXPECT_THAT(refused("junk.mp4 -o out"), HasSubstr("apt-get install ffmpeg"));
    GTEST_SKIP() << "NOT RUN: ffmpeg is not installed (apt-get install ffmpeg)";
  }
  EXPECT_THAT(refused("junk.mp4 -o out"), HasSubstr("ffprobe cannot read it"));
  for (const char* camera : {"left", "right"})
    ASSERT_EQ(
        std::system(("ffmpeg -v error -nostdin -f lavfi -i testsrc2=size=64x48:rate=10:duration=2"
                     " -c:v ffv1 '" +
                     (folder_ / (std::string(camera) + ".mkv")).string() + "'")
                        .c_str()),
        0);
  const Result got = hookeye("import left.mkv right.mkv -o lab --frames 5");
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("20 frames in 1.9 s"));
  EXPECT_THAT(got.out, HasSubstr("left_0001.tif to left_0005.tif"));
  EXPECT_THAT(too_long(got.out), testing::IsEmpty());
  EXPECT_TRUE(fs::exists(folder_ / "lab/photos/right_0005.tif"));
  EXPECT_FALSE(fs::exists(folder_ / "lab/photos/.hookeye-frames"));
  // one of them is cut
  fs::resize_file(folder_ / "right.mkv", fs::file_size(folder_ / "right.mkv") / 2);
  const Result cut = hookeye("import left.mkv right.mkv -o cut");
  EXPECT_THAT(cut.out, HasSubstr("ffprobe says of it: "));
  EXPECT_THAT(cut.err, testing::ContainsRegex("right.mkv ends 1.* s before left.mkv"));
  const Result again = hookeye("import left.mkv -o lab");
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("photos of a camera of this name are there"));
}

const std::string kDeck =
    "*NODE\n1, 0, 0, 0\n2, 10, 0, 0\n3, 0, 10, 0\n4, 0, 0, 10\n"
    "*ELEMENT, TYPE=C3D4, ELSET=EALL\n1, 1, 2, 3, 4\n*NSET, NSET=base\n1, 2, 3\n"
    "*MATERIAL, NAME=GEL\n*HYPERELASTIC, NEO HOOKE\n0.025, 4.\n"
    "*SOLID SECTION, ELSET=EALL, MATERIAL=GEL\n"
    "*STEP\n*STATIC\n*BOUNDARY\nbase, 1, 3\n4, 3, 3, 1.\n*END STEP\n";

TEST_F(Cli, ImportWritesTheBodyAndTheCasesOfADeck) {
  write("lift.inp", kDeck);
  const Result got = hookeye("import lift.inp -o . --json");
  ASSERT_EQ(got.status, 0) << got.err;
  const json document = json::parse(got.out);
  EXPECT_EQ(document["elements"], 1);
  EXPECT_EQ(document["examples"][0]["supports"], 2);
  write("capture.yaml",
        "hookeye: 1\nunits: {length: mm, force: N}\n" + read(folder_ / "body.yaml"));
  const Result checked = hookeye("check . --json");
  ASSERT_EQ(checked.status, 0) << checked.err;
  EXPECT_EQ(json::parse(checked.out)["examples"].size(), 1u);
  EXPECT_EQ(hookeye("import lift.inp -o .").status, 0);  // what import wrote it writes anew
  write("examples.yaml", "examples: {}\n");
  const std::string body = read(folder_ / "body.yaml");
  const Result kept = hookeye("import lift.inp -o .");
  EXPECT_EQ(kept.status, 2);
  EXPECT_THAT(kept.err, HasSubstr("examples.yaml: there is another file of this name"));
  EXPECT_EQ(read(folder_ / "body.yaml"), body);
}

TEST_F(Cli, ImportOfABadDeckWritesNothing) {
  std::string deck = kDeck;
  deck.replace(deck.find("base, 1, 3"), 4, "bass");
  write("lift.inp", deck);
  const Result got = hookeye("import lift.inp -o out");
  EXPECT_EQ(got.status, 2);
  EXPECT_THAT(got.err, HasSubstr("lift.inp:17: there is no node set `bass`"));
  EXPECT_THAT(got.err, HasSubstr("did you mean `base`?"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_THAT(hookeye("import lift.inp -o out --scale 10").err,
              HasSubstr("a deck keeps its own units"));
  EXPECT_THAT(hookeye("import deck -o out").err, HasSubstr("no source behind the kind"));
}

}  // namespace
}  // namespace hookeye::test
