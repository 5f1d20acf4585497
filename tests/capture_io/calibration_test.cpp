#include <fmt/format.h>
#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <vector>

#include "capture_io/camera.h"
#include "capture_io/capture_folder.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye::test {
namespace {

class EveryCalibrationFormat : public testing::TestWithParam<const char*> {};

TEST_P(EveryCalibrationFormat, ReadsWhatOpenCvWrites) {
  const TemporaryFolder folder;
  const std::string file = (folder / (std::string("camera.") + GetParam())).string();
  {
    cv::FileStorage out(file, cv::FileStorage::WRITE);
    out << "image_width" << 640 << "image_height" << 480;
    out << "camera_matrix" << (cv::Mat_<double>(3, 3) << 801, 0, 320.5, 0, 802, 241, 0, 0, 1);
    out << "distortion_coefficients"
        << (cv::Mat_<double>(1, 8) << -0.1, 0.2, 0.001, 0.002, -0.3, 0.4, 0.5, 0.6);
    out << "R" << (cv::Mat_<double>(3, 3) << 0, -1, 0, 1, 0, 0, 0, 0, 1);
    out << "T" << (cv::Mat_<double>(3, 1) << 1, 2, 3);
  }
  bool has_pose = false;
  const Camera camera = read_opencv_calibration(file, &has_pose);
  EXPECT_TRUE(has_pose);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 801);
  EXPECT_EQ(camera.fy, 802);
  EXPECT_EQ(camera.cx, 320.5);
  EXPECT_EQ(camera.cy, 241);
  EXPECT_EQ(camera.distortion, (std::vector<double>{-0.1, 0.2, 0.001, 0.002, -0.3, 0.4, 0.5, 0.6}));
  EXPECT_EQ(camera.R(0, 1), -1);
  EXPECT_EQ(camera.R(1, 0), 1);
  EXPECT_EQ(camera.t, Eigen::Vector3d(1, 2, 3));
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryCalibrationFormat, testing::Values("yml", "xml", "json"));

TEST(CalibrationTest, RotationVectorAndMissingPose) {
  const TemporaryFolder folder;
  write_text(folder / "a.yml",
             "%YAML:1.0\n---\nK: [100., 0., 5., 0., 100., 5., 0., 0., 1.]\n"
             "rvec: [0., 0., 1.5707963267948966]\ntvec: [0., 0., 9.]\n");
  bool has_pose = false;
  const Camera a = read_opencv_calibration(folder / "a.yml", &has_pose);
  EXPECT_TRUE(has_pose);
  EXPECT_NEAR(a.R(1, 0), 1, 1e-15);
  EXPECT_EQ(a.width, 0);
  write_text(folder / "b.yml", "%YAML:1.0\n---\nK: [100., 0., 5., 0., 100., 5., 0., 0., 1.]\n");
  read_opencv_calibration(folder / "b.yml", &has_pose);
  EXPECT_FALSE(has_pose);
}

TEST(CalibrationTest, ARotationVectorInDegreesIsRefused) {
  const TemporaryFolder folder;
  const auto read = [&](double turn) -> std::string {
    write_text(folder / "a.yml",
               "%YAML:1.0\n---\nK: [100., 0., 5., 0., 100., 5., 0., 0., 1.]\nrvec: [0., 0., " +
                   std::to_string(turn) + "]\ntvec: [0., 0., 9.]\n");
    try {
      read_opencv_calibration(folder / "a.yml");
      return "";
    } catch (const InputError& error) {
      return error.wrong() + "; " + error.right();
    }
  };
  EXPECT_EQ(read(3.2), "") << "the other way round is meant";
  EXPECT_EQ(read(20.0),
            "`rvec` turns by 20 rad, more than a whole turn; a rotation vector is in "
            "radians: multiply degrees by pi/180");
}

/// A fisheye is told by OpenCV's flag, or by the name that ROS and Kalibr give its distortion.
TEST(CalibrationTest, FisheyeAndSkew) {
  const TemporaryFolder folder;
  const std::string k = "%YAML:1.0\n---\nK: [100., 2., 5., 0., 101., 6., 0., 0., 1.]\n";
  const std::string d = "D: [0.1, 0.2, 0.3, 0.4]\n";
  const std::pair<std::string, std::string> files[] = {
      {d + "fisheye_model: 1\n", "fisheye"},
      {d + "fisheye_model: 0\n", "perspective"},
      {d + "distortion_model: equidistant\n", "fisheye"},
      {d + "distortion_model: \"plumb_bob\"\n", "perspective"},
      {d, "perspective"},
      {"fisheye_model: 1\n", "fisheye"}};
  for (const auto& [text, model] : files) {
    write_text(folder / "a.yml", k + text);
    const Camera camera = read_opencv_calibration(folder / "a.yml");
    EXPECT_EQ(camera.model->name(), model) << text;
    EXPECT_EQ(camera.skew, 2);
    EXPECT_EQ(camera.distortion.size(), text.find("D:") == 0 ? 4u : 0u);
  }
}

/// ROS writes yaml without OpenCV's mark, which its reader refuses.
TEST(CalibrationTest, PlainYamlIsReadWithItsLines) {
  const TemporaryFolder folder;
  const std::string text =
      "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [801, 0, 320.5, 0, 802, 241, 0, 0, 1]\ndistortion_model: plumb_bob\n"
      "distortion_coefficients: {rows: 1, cols: 5, data: [-0.1, 0.2, 0.001, 0.002, -0.3]}\n";
  write_text(folder / "a.yaml", text);
  const Camera camera = read_opencv_calibration(folder / "a.yaml");
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.fy, 802);
  EXPECT_EQ(camera.distortion, (std::vector<double>{-0.1, 0.2, 0.001, 0.002, -0.3}));
  write_text(folder / "a.yaml", text + "image_width: 5\n");
  try {
    read_opencv_calibration(folder / "a.yaml");
    ADD_FAILURE() << "two widths are accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, 9);
  }
}

/// OpenCV's reader calls itself for every level: a stack has an end.
TEST(CalibrationTest, DeepNestingIsNoCrash) {
  const TemporaryFolder folder;
  const auto repeated = [](const std::string& text) {
    std::string all;
    for (int i = 0; i < 60000; ++i) all += text;
    return all;
  };
  const std::pair<const char*, std::string> files[] = {
      {"a.yml", "%YAML:1.0\n---\nK: " + repeated("[") + "\n"},
      {"a.json", "{\"K\": " + repeated("[") + repeated("]") + "}"},
      {"a.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>" + repeated("<K>") + "\n"}};
  for (const auto& [name, text] : files) {
    write_text(folder / name, text);
    try {
      read_opencv_calibration(folder / name);
      ADD_FAILURE() << name << " was read";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().file, (folder / name).string());
      EXPECT_NE(error.wrong().find("not an OpenCV file"), std::string::npos) << error.what();
    }
  }
}

/// A whole file as cv::FileStorage writes it, cut off anywhere: never read, and where a list is cut
/// the line where the file ends and that where the list begins are told.
TEST(CalibrationTest, WhatIsCutOffIsToldByItsLine) {
  const TemporaryFolder folder;
  const std::string list = "[ 800., 0., 320., 0.,\n       801., 240., 0., 0., 1. ]";
  const std::string matrix = "   rows: 3\n   cols: 3\n   dt: d\n   data: ";
  const std::string yml = "%YAML:1.0\n---\nname: \"it's [ a lens\"\nK: !!opencv-matrix\n" + matrix +
                          list + "\nimage_width: 640\nimage_height: 480\n";
  const auto complaint = [&](const std::string& name, const std::string& text) -> std::string {
    write_text(folder / name, text);
    try {
      read_opencv_calibration(folder / name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  ASSERT_EQ(complaint("whole.yml", yml), "");
  const size_t begin = yml.find("[ 800"), end = yml.find(" ]\n");
  const std::string file = (folder / "cut.yml").string();
  for (size_t at = begin + 1; at <= end; at += 5) {
    const std::string told = complaint("cut.yml", yml.substr(0, at));
    const int line = at <= yml.find("\n       801") + 8 ? 8 : 9;
    EXPECT_EQ(told,
              fmt::format("{}:{}: the file ends early: `[` of line 8 is not closed\n  copy the "
                          "whole file again, or write it anew with cv::FileStorage",
                          file, line))
        << at;
  }
  for (size_t at = 12; at < end; at += 3)
    EXPECT_NE(complaint("cut.yml", yml.substr(0, at)), "") << at;
  EXPECT_THAT(complaint("cut.yml", yml.substr(0, yml.find("   data"))),
              testing::HasSubstr("`K` has rows but no data"));
  EXPECT_THAT(complaint("ros.yaml", "image_width: 640\nK: [800., 0., 320.,\n  0., 80"),
              testing::HasSubstr("ros.yaml:3: the file ends early: `[` of line 2 is not closed"));
  EXPECT_THAT(complaint("cut.json", "{\n  \"K\": [800.0, 0.0,\n    320.0"),
              testing::HasSubstr("cut.json:3: the file ends early: `[` of line 2 is not closed"));
  EXPECT_THAT(complaint("cut.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n<K>800. 0. 320.\n"),
              testing::HasSubstr("cut.xml:3: the file ends early: `<opencv_storage>` of line 2"));
}

/// Broken calibrations and what is said about them.
TEST(CalibrationTest, FaultsAreNamed) {
  const TemporaryFolder folder;
  const std::string k = "K: [100., 0., 5., 0., 100., 5., 0., 0., 1.]\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "there is no camera matrix"},
      {"K: [100., 0.", "the file ends early: `[` of line 3 is not closed"},
      {"K: hello\n", "`K` is not a matrix"},
      {"K: [100., 0., 5.]\n", "`K` has 3 numbers"},
      {"K: [0., 0., 5., 0., 100., 5., 0., 0., 1.]\n", "the focal lengths are 0 and 100 px"},
      {"K: [.Nan, 1., 5., 0., 100., 5., 0., 0., 1.]\n", "`K` is not finite"},
      {k + "D: [1., 2., 3.]\n", "`D` has 3 coefficients"},
      {k + "fisheye_model: 1\nD: [1., 2., 3., 4., 5.]\n", "`D` has 5 coefficients"},
      {k + "distortion_model: mercator\n", "`distortion_model` is `mercator`"},
      {k + "distortion_model: 3\n", "`distortion_model` is no name"},
      {k + "image_width: 0\nimage_height: 3\n", "the picture size is 0 x 3"},
      {k + "R: [0., 0., 0.]\n", "the pose is incomplete"},
      {k + "R: [0., 0., 0.]\nT: [1., 2.]\n", "`T` has 2 numbers"},
      {k + "R: [1., 0., 0., 0., 2., 0., 0., 0., 1.]\nT: [1., 2., 3.]\n", "`R` is not orthonormal"},
  };
  for (const auto& [text, wrong] : cases) {
    write_text(folder / "c.yml", "%YAML:1.0\n---\n" + text);
    try {
      read_opencv_calibration(folder / "c.yml");
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      EXPECT_EQ(error.wrong(), wrong) << text;
    }
  }
}

}  // namespace
}  // namespace hookeye::test
