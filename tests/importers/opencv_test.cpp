#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "core/text_file.h"
#include "importers/published.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

const cv::Matx33d kM1(801, 0.6, 320.5, 0, 802, 241, 0, 0, 1),
    kM2(790, 0, 311, 0, 791, 235, 0, 0, 1);
const cv::Matx<double, 1, 5> kD1(-0.21, 0.12, 0.001, -0.002, 0.03);
const cv::Matx<double, 1, 8> kD2(-0.2, 0.1, 0.002, 0.001, 0.02, 0.05, 0.01, 0.003);

cv::Matx33d cv_matrix(const Matrix3d& R) {
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

/// What cv::stereoCalibrate gives, as OpenCV's sample stores it.
void write_pair(const std::string& intrinsics, const std::string& extrinsics, const Pose& pose) {
  {
    cv::FileStorage out(intrinsics, cv::FileStorage::WRITE);
    out << "M1" << cv::Mat(kM1) << "D1" << cv::Mat(kD1) << "M2" << cv::Mat(kM2) << "D2"
        << cv::Mat(kD2);
  }
  cv::FileStorage out(extrinsics, cv::FileStorage::WRITE);
  out << "R" << cv::Mat(cv_matrix(pose.R));
  out << "T" << (cv::Mat_<double>(3, 1) << pose.t.x(), pose.t.y(), pose.t.z());
}

/// Pixel by OpenCV itself; skew, which it leaves out, added by the camera matrix.
template <class Lens>
std::function<Vector2d(const Vector3d&)> by_opencv(const cv::Matx33d& matrix, const Lens& lens) {
  return [=](const Vector3d& x) {
    std::vector<cv::Point2d> plane;
    cv::projectPoints(std::vector<cv::Point3d>{{x.x(), x.y(), x.z()}}, cv::Vec3d(), cv::Vec3d(),
                      cv::Matx33d::eye(), lens, plane);
    const cv::Vec3d pixel = matrix * cv::Vec3d(plane[0].x, plane[0].y, 1);
    return Vector2d(pixel[0], pixel[1]);
  };
}

class OpenCvPair : public testing::TestWithParam<const char*> {};

TEST_P(OpenCvPair, ProjectsAsOpenCvDoes) {
  const TemporaryFolder folder;
  const std::string ending = GetParam();
  const Importer::Sources files{folder / ("in." + ending), folder / ("ex." + ending)};
  const Pose pose = some_pose();
  write_pair(files[0], files[1], pose);
  EXPECT_EQ(recognise(files).name(), "opencv");
  const Imported imported = import_from("opencv", files, {640, 480});
  expect_projects(imported, "cam1", {}, by_opencv(kM1, kD1));
  expect_projects(imported, "cam2", pose, by_opencv(kM2, kD2));
  const Imported scaled = import_from("opencv", files, {640, 480, 25.0});
  EXPECT_LT((camera_of(scaled, "cam2").centre() - 25 * camera_of(imported, "cam2").centre()).norm(),
            1e-12);
}

INSTANTIATE_TEST_SUITE_P(Formats, OpenCvPair, testing::Values("yml", "xml", "json"));

TEST(OpenCvImport, OneCameraAndItsSize) {
  const TemporaryFolder folder;
  const std::string file = (folder / "left.yml").string();
  {
    cv::FileStorage out(file, cv::FileStorage::WRITE);
    out << "image_width" << 640 << "image_height" << 480 << "camera_matrix" << cv::Mat(kM1)
        << "distortion_coefficients" << cv::Mat(kD1);
  }
  expect_projects(import_from("opencv", {file}), "left", {}, by_opencv(kM1, kD1));
  EXPECT_EQ(complaint(folder.path(),
                      [&] {
                        import_from("opencv", {file}, {320, 240});
                      }),
            "left.yml: `left` was calibrated for 640 x 480 px, --size says 320 x 240\n"
            "  leave --size out; photos have the size that was calibrated");
}

TEST(OpenCvImport, AFisheyeThatDoesNotSaySoIsTold) {
  const TemporaryFolder folder;
  write_text(folder / "a.yml",
             "%YAML:1.0\n---\nK: [100., 0., 5., 0., 100., 5., 0., 0., 1.]\nD: [0.1, 0., 0., 0.]\n");
  const Imported imported = import_from("opencv", {folder / "a.yml"}, {10, 10});
  ASSERT_EQ(imported.said.size(), 1u);
  EXPECT_THAT(imported.said[0], testing::HasSubstr("write `projection: fisheye`"));
}

TEST(OpenCvImport, FaultsAreNamed) {
  const TemporaryFolder folder;
  write_pair((folder / "in.yml").string(), (folder / "ex.yml").string(), {});
  const std::string k = "K: [100., 0., 5., 0., 100., 5., 0., 0., 1.]\n";
  write_text(folder / "a.yml", "%YAML:1.0\n---\n" + k);
  write_text(folder / "bare.yml", "# no mark\n" + k + "D: [1, 2, 3]\n");
  const auto told = [&](const Importer::Sources& sources, const ImportOptions& options = {}) {
    return complaint(folder.path(), [&] { import_from("opencv", sources, options); });
  };
  EXPECT_EQ(told({folder / "in.yml"}),
            "in.yml: it has two cameras and not their pose, `R` and `T`\n"
            "  name the file with the extrinsics behind it");
  EXPECT_EQ(told({folder / "in.yml", folder / "ex.yml"}),
            "in.yml: the picture size of `cam1` is not in it\n"
            "  give the size of its photos: --size 1280x1024");
  EXPECT_EQ(told({folder / "a.yml", folder / "a.yml"}),
            "a.yml: where `a` stands is not in it\n"
            "  give R and T (world to camera), or calibrate the cameras as a pair");
  EXPECT_EQ(told({folder / "ex.yml"}),
            "ex.yml: there is no camera matrix\n  the key `camera_matrix` or `K` is read");
  EXPECT_EQ(told({folder / "bare.yml"}),
            "bare.yml:3: `D` has 3 coefficients\n"
            "  0, 4, 5, 8, 12 or 14 are expected, in OpenCV's order");
}

}  // namespace
}  // namespace hookeye::test
