// How well cameras are known: `camera_covariance: FILE`.
#include "capture_io/camera_covariance.h"

#include <gmock/gmock.h>

#include <fstream>

#include "capture_io/broken_case.h"

namespace hookeye::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kFile = R"(unit: mm
frame: camera
numbers:
  front: [fx, cx, rotation_y, shift_z]
  top: [fx, shift_x]
covariance:
  - [4, 0.5, 0, 0.2, 0, 0]
  - [0.5, 1, 0.0001, 0, 0, 0]
  - [0, 0.0001, 1e-6, 0, 0, 2e-5]
  - [0.2, 0, 0, 0.09, 0, 0]
  - [0, 0, 0, 0, 0.01, 0]
  - [0, 0, 2e-5, 0, 0, 0.01]
)";

/// The fixture's capture with a covariance of two of its three cameras.
struct Known {
  CaptureFixture capture;
  std::string file = kFile;

  Known() { capture.replace("light:\n", "camera_covariance: known.yaml\nlight:\n"); }
  void replace(const std::string& from, const std::string& to) {
    const size_t at = file.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    file.replace(at, from.size(), to);
  }
  Capture read() const {
    capture.write_file("known.yaml", file);
    capture.write();
    return read_capture(capture.folder());
  }
  std::string complaint() const {
    capture.write_file("known.yaml", file);
    capture.write();
    return capture.complaint();
  }
};

const MeasuredSpec* calibration_of(const ExampleSpec& example) {
  for (const MeasuredSpec& one : example.measured)
    if (one.kind == MeasuredSpec::Kind::calibration) return &one;
  return nullptr;
}

TEST(CameraCovariance, TheFirstFittedExampleMeasuresTheCameras) {
  const Capture capture = Known().read();
  ASSERT_TRUE(capture.camera_covariance);
  const CameraCovariance& known = *capture.camera_covariance;
  EXPECT_THAT(known.cameras(), ElementsAre("front", "top"));
  EXPECT_EQ(known.deviation(0), 2.0);
  EXPECT_EQ(known.values(5, 2), 2e-5);
  const MeasuredSpec* measured = calibration_of(capture.examples.at(0));
  ASSERT_TRUE(measured);
  EXPECT_EQ(measured->value, Eigen::VectorXd::Zero(14));
  EXPECT_EQ(measured->sigma, Eigen::VectorXd::Ones(14));
  EXPECT_FALSE(calibration_of(capture.examples.at(1)));
  EXPECT_FALSE(is_on_body(*measured));
}

TEST(CameraCovariance, LengthsAreTakenIntoTheCapturesUnit) {
  Known known;
  known.replace("unit: mm", "unit: m");
  const Eigen::MatrixXd in_m = known.read().camera_covariance->values;
  EXPECT_NEAR(in_m(3, 3), 0.09e6, 1e-6) << "a shift";
  EXPECT_NEAR(in_m(0, 3), 200.0, 1e-9) << "one of both";
  EXPECT_EQ(in_m(0, 0), 4.0) << "pixels";
  EXPECT_NEAR(in_m(4, 4), 1e-8, 1e-20) << "pixels a length, where rays are parallel";
  known.capture.replace("camera_covariance: known.yaml",
                        "camera_covariance: {from: known.yaml, scale: 10}");
  EXPECT_NEAR(known.read().camera_covariance->values(3, 3), 9.0, 1e-12)
      << "a scale that is told stands for the unit";
}

/// Turns and shifts are the camera's own: what the world is called does not count.
TEST(CameraCovariance, APlacementLeavesItAsItIs) {
  Known known;
  const Eigen::MatrixXd before = known.read().camera_covariance->values;
  known.capture.replace("placement: fit",
                        "placement: {rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]], translation: "
                        "[0, 0, 30]}");
  EXPECT_EQ(known.read().camera_covariance->values, before);
}

TEST(CameraCovariance, OnlyCamerasWithFittedPhotosAreLeftIn) {
  Known known;
  known.capture.replace("      top: {file: photos/top.png, kind: silhouette}\n", "");
  const Capture capture = known.read();
  EXPECT_THAT(capture.camera_covariance->cameras(), ElementsAre("front"));
  EXPECT_EQ(capture.camera_covariance->values.rows(), 4);
  EXPECT_EQ(calibration_of(capture.examples[0])->value.size(), 7);
}

/// A calibration may have more cameras than photos were taken with.
TEST(CameraCovariance, ACameraThatWasLeftOutOfTheCaptureIsPassedBy) {
  Known known;
  known.replace("  top: [fx, shift_x]\n", "  left: [fx]\n  top: [fx]\n  back: [shift_x]\n");
  known.file.resize(known.file.find("covariance:\n"));
  known.file += "covariance:\n";
  for (int i = 0; i < 7; ++i) {
    known.file += "  - [";
    for (int k = 0; k < 7; ++k) known.file += std::string(k ? ", " : "") + (i == k ? "1" : "0");
    known.file += "]\n";
  }
  const Capture capture = known.read();
  EXPECT_THAT(capture.camera_covariance->strangers, ElementsAre("back"));
  EXPECT_THAT(capture.camera_covariance->cameras(), ElementsAre("front", "left", "top"));
  EXPECT_EQ(capture.camera_covariance->values.rows(), 6);
}

TEST(CameraCovariance, WhatIsWrittenIsRead) {
  Known known;
  const Capture before = known.read();
  CameraCovariance all = *before.camera_covariance;
  all.numbers.push_back({"top", "shift_y"});  // a given one
  all.values.conservativeResizeLike(Eigen::MatrixXd::Zero(7, 7));
  known.file = camera_covariance_text(all, "mm", "# by whom\n");
  const Capture after = known.read();
  EXPECT_EQ(after.camera_covariance->values, before.camera_covariance->values);
  EXPECT_THAT(known.file, HasSubstr("[fx, shift_x]\n"));
}

struct WrongCovariance {
  const char *from, *to, *message;
};

TEST(CameraCovariance, WhatIsWrongIsToldWithItsPlace) {
  for (const WrongCovariance& wrong : {
           WrongCovariance{"  top: [", "  topp: [",
                           "known.yaml:5:3: the capture has no camera `topp`, and nothing is told "
                           "of its cameras left, top\n  did you mean `top`?"},
           WrongCovariance{"rotation_y", "rotation_w",
                           "known.yaml:4:19: camera `front` has no number `rotation_w`\n  did you "
                           "mean `rotation_x`?"},
           WrongCovariance{
               "[fx, cx,", "[fx, fx,",
               "known.yaml:4:15: `fx` of `front` stands twice\n  name each number once"},
           WrongCovariance{"  - [0, 0, 2e-5, 0, 0, 0.01]\n", "",
                           "known.yaml:7:3: the covariance has 5 rows for 6 numbers\n  6 rows of 6 "
                           "numbers, one for each of `numbers`"},
           WrongCovariance{"[4, 0.5, 0, 0.2, 0, 0]", "[4, 0.5, 0, 0.2, 0]",
                           "known.yaml:7:5: row 1 of the covariance has 5 numbers\n  6 rows of 6 "
                           "numbers, one for each of `numbers`"},
           WrongCovariance{"[0, 0, 0, 0, 0.01, 0]", "[0, 0, 0, 0, .nan, 0]",
                           "known.yaml:11:18: a number of row 5 of the covariance is `.nan`\n  a "
                           "finite number is expected"},
           WrongCovariance{"[0, 0, 0, 0, 0.01, 0]", "[0, 0, 0, 0, 0, 0]",
                           "known.yaml:11:5: the variance of `fx` of `top` is 0\n  a number above "
                           "zero; a number that is known exactly is left out of `numbers` and of "
                           "the rows and columns"},
           WrongCovariance{"[0.5, 1, 0.0001", "[0.7, 1, 0.0001",
                           "known.yaml:8:5: the covariance is not symmetric: of `cx` of `front` "
                           "and `fx` of `front` it has 0.7 and 0.5\n  one number for both: the "
                           "covariance of a pair has no order"},
           WrongCovariance{"unit: mm", "unit: inch",
                           "known.yaml:1:7: the unit of the covariance is `inch`\n  one of mm, cm, "
                           "m, um is expected"},
           WrongCovariance{
               "frame: camera", "frame: world",
               "known.yaml:2:8: the frame of the covariance is `world`\n  one of camera "
               "is expected"},
           WrongCovariance{"frame: camera\n", "",
                           "known.yaml:1:1: the camera covariance lacks `frame`\n  write `frame: "
                           "camera`: turns and shifts are along the axes of each camera"},
       }) {
    Known known;
    known.replace(wrong.from, wrong.to);
    EXPECT_EQ(known.complaint(), wrong.message);
  }
}

TEST(CameraCovariance, AMatrixThatIsNoneIsRefused) {
  Known known;
  known.replace("[4, 0.5,", "[4, 2.5,");
  known.replace("[0.5, 1,", "[2.5, 1,");
  EXPECT_THAT(known.complaint(),
              HasSubstr("known.yaml:8:5: the covariance is not positive definite: the correlation "
                        "of `cx` of `front` and `fx` of `front` is 1.25"));
  Known three;  // each pair is well, all three are not
  three.file =
      "unit: mm\nframe: camera\nnumbers: {front: [fx, fy, cx]}\ncovariance:\n  - [1, 0.9, "
      "-0.9]\n  - [0.9, 1, 0.9]\n  - [-0.9, 0.9, 1]\n";
  EXPECT_THAT(three.complaint(),
              HasSubstr("known.yaml:5:3: the covariance is not positive definite\n  some mix"));
  three.file = "";
  EXPECT_THAT(three.complaint(), HasSubstr("known.yaml: the file is empty\n  write `unit`"));
}

}  // namespace
}  // namespace hookeye::test
