// `cameras: {from: FILE}`: the map of cameras in a file of its own.
#include <gtest/gtest.h>

#include "capture_io/capture.h"
#include "capture_io/capture_folder.h"
#include "capture_io/fingerprints.h"
#include "capture_io/yaml_place.h"

namespace hookeye::test {
namespace {

TEST(CamerasFileTest, TheCamerasAreThoseOfTheFile) {
  CaptureFixture capture;
  capture.write();
  const Capture in_place = read_capture(capture.folder());
  capture.part_cameras();
  capture.write();
  const Capture parted = read_capture(capture.folder());
  ASSERT_EQ(parted.cameras.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(parted.cameras[i].name, in_place.cameras[i].name);
    EXPECT_TRUE(parted.cameras[i].same_optics(in_place.cameras[i]));
    EXPECT_EQ(parted.cameras[i].R, in_place.cameras[i].R);
    EXPECT_EQ(parted.cameras[i].t, in_place.cameras[i].t);
  }
}

TEST(CamerasFileTest, ACameraMayBeCalledFrom) {
  CaptureFixture capture;
  capture.replace("  top:\n", "  from:\n");
  capture.replace("      top: {file: photos/top.png", "      from: {file: photos/top.png");
  capture.write();
  EXPECT_EQ(read_capture(capture.folder()).cameras[2].name, "from");
}

TEST(CamerasFileTest, PlacesAreThoseOfTheFile) {
  CaptureFixture capture;
  capture.part_cameras();
  capture.write();
  const YamlPlaces places(capture.folder() / "capture.yaml", "here/capture.yaml");
  EXPECT_EQ(places.of({"cameras", "left"}).str(), "here/cameras.yaml:7:3");
  EXPECT_EQ(places.of({"light"}).str(), "here/capture.yaml:15:1");
}

/// A run is made from the file, and from the calibrations that it names.
TEST(CamerasFileTest, ItAndWhatItNamesAreInputs) {
  CaptureFixture capture;
  capture.part_cameras();
  capture.write();
  const auto then = fingerprints(capture.folder() / "capture.yaml");
  EXPECT_TRUE(then.contains("cameras.yaml"));
  EXPECT_TRUE(then.contains("left.yml"));
  capture.write_file("left.yml", "%YAML:1.0\n");
  EXPECT_EQ(changed_since(then, fingerprints(capture.folder() / "capture.yaml")), "left.yml");
}

struct Damage {
  const char* what;
  const char* cameras;  ///< the file; null: as it is
  std::pair<const char*, const char*> swap;
  const char* message;
};

const Damage damages[] = {
    {"an unknown key of a camera",
     "# by hand\ncameras:\n  front: {size: [8, 6], lens: 5}\n",
     {},
     "cameras.yaml:3:25: camera `front` has no key `lens`\n"
     "  known here: size, projection, intrinsics, pose, calibration, vignetting, chromatic_shift"},
    {"no file of that name",
     nullptr,
     {"from: cameras.yaml", "from: camera.yaml"},
     "capture.yaml:14:17: file of cameras is `camera.yaml`\n"
     "  there is no such file; did you mean `cameras.yaml`?"},
    {"a calibration as it is",
     nullptr,
     {"from: cameras.yaml", "from: left.yml"},
     "left.yml:3:1: the file of cameras has no key `image_width`\n"
     "  known here: cameras"},
    {"no yaml",
     nullptr,
     {"from: cameras.yaml", "from: grip.txt"},
     "capture.yaml:14:17: file of cameras is `grip.txt`\n"
     "  a file of type .yaml, .yml is expected"},
    {"out of the folder",
     nullptr,
     {"from: cameras.yaml", "from: ../cameras.yaml"},
     "capture.yaml:14:17: file of cameras is `../cameras.yaml`\n"
     "  the path leads out of the capture's folder: put the file inside"},
    {"some here and some there",
     nullptr,
     {"{from: cameras.yaml}", "{from: cameras.yaml, top: {}}"},
     "capture.yaml:14:31: cameras has both `from` and `top`\n"
     "  keep all of them in the file, or all of them here"},
    {"the map alone",
     "front: {size: [8, 6]}\n",
     {},
     "cameras.yaml:1:1: the file of cameras has no key `front`\n"
     "  known here: cameras"},
    {"a file that names a file",
     "cameras: {from: more.yaml}\n",
     {},
     "cameras.yaml:1:17: a second file of cameras is `more.yaml`\n"
     "  the map itself stands in this file"},
    {"an empty file",
     "# nothing\n",
     {},
     "cameras.yaml: the file is empty\n"
     "  write `cameras:`, and below it the map as a capture has it"},
    {"two of them",
     "cameras: {}\n---\ncameras: {}\n",
     {},
     "cameras.yaml:3:1: a second yaml document begins here\n"
     "  one file holds one map of cameras: remove the line `---` and what follows"},
};

TEST(CamerasFileTest, FaultsAreToldWithTheFileAndItsLine) {
  for (const Damage& damage : damages) {
    CaptureFixture capture;
    capture.part_cameras();
    if (damage.cameras) capture.write_file("cameras.yaml", damage.cameras);
    if (damage.swap.first) capture.replace(damage.swap.first, damage.swap.second);
    capture.write();
    EXPECT_EQ(capture.complaint(), damage.message) << damage.what;
  }
}

}  // namespace
}  // namespace hookeye::test
