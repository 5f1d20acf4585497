// ROS camera_info and Kalibr's camchain, written as their documents say.
#include <gtest/gtest.h>

#include "core/text_file.h"
#include "importers/published.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

std::string matrix(const char* name, int rows, int cols, const std::string& data) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", name, rows, cols, data);
}

/// As camera_calibration stores a camera: `shift` is the fourth column of the projection matrix.
std::string camera_info(const std::string& name, const std::string& model, const std::string& lens,
                        int count, const Matrix3d& rectify, double shift) {
  Eigen::Matrix<double, 3, 4> project;
  project << 700, 0, 300, shift, 0, 700, 250, 0, 0, 0, 1, 0;
  return fmt::format("image_width: 640\nimage_height: 480\ncamera_name: {}\n", name) +
         matrix("camera_matrix", 3, 3, "[801, 0, 320.5, 0, 802, 241, 0, 0, 1]") +
         "distortion_model: " + model + "\n" + matrix("distortion_coefficients", 1, count, lens) +
         matrix("rectification_matrix", 3, 3, list(rectify)) +
         matrix("projection_matrix", 3, 4, list(project));
}

Vector2d pixel_of(const Vector2d& plane) {
  return {801 * plane.x() + 320.5, 802 * plane.y() + 241};
}

TEST(RosImport, APairProjectsAsItsDocumentSays) {
  const TemporaryFolder folder;
  const Matrix3d left = turn({0, 1, 0.1}, 0.05), right = turn({0.1, 1, 0}, -0.07);
  write_text(folder / "left.yaml",
             camera_info("cam/left", "plumb_bob", "[-0.2, 0.1, 0.001, -0.002, 0.03]", 5, left, 0));
  write_text(folder / "right.yaml",
             camera_info("cam/right", "rational_polynomial",
                         "[-0.2, 0.1, 0.002, 0.001, 0.02, 0.05, 0.01, 0.003]", 8, right, -84));
  const Importer::Sources files{folder / "left.yaml", folder / "right.yaml"};
  EXPECT_EQ(recognise(files).name(), "ros");
  const Imported imported = import_from("ros", files);
  // A point x of the first's rectified axes is x + (Tx / fx', 0, 0) in the second's.
  expect_projects(imported, "cam_left", {left.transpose(), Vector3d::Zero()},
                  [](const Vector3d& x) {
                    return pixel_of(brown(x, {-0.2, 0.1, 0.001, -0.002, 0.03}));
                  });
  expect_projects(imported, "cam_right",
                  {right.transpose(), right.transpose() * Vector3d(-84.0 / 700, 0, 0)},
                  [](const Vector3d& x) {
                    return pixel_of(brown(x, {-0.2, 0.1, 0.002, 0.001, 0.02, 0.05, 0.01, 0.003}));
                  });
}

TEST(RosImport, AFisheyeAndFaults) {
  const TemporaryFolder folder;
  const Matrix3d none = Matrix3d::Identity();
  const auto told = [&](const std::string& text) {
    write_text(folder / "a.yaml", text);
    return complaint(folder.path(), [&] { import_from("ros", {folder / "a.yaml"}); });
  };
  const std::string fisheye =
      camera_info("wide", "equidistant", "[0.02, -0.01, 0.004, -0.001]", 4, none, 0);
  EXPECT_EQ(told(fisheye), "");
  expect_projects(import_from("ros", {folder / "a.yaml"}), "wide", {}, [](const Vector3d& x) {
    return pixel_of(equidistant(x, {0.02, -0.01, 0.004, -0.001}));
  });
  EXPECT_EQ(told(camera_info("a", "mercator", "[0, 0, 0, 0]", 4, none, 0)),
            "a.yaml:8: `distortion_model` is `mercator`\n"
            "  one of plumb_bob, rational_polynomial, thin_prism, radtan, none, and of a fisheye "
            "equidistant or fisheye is expected");
  EXPECT_EQ(told(camera_info("a", "plumb_bob", "[0, 0, 0, 0, 0]", 4, none, 0)),
            "a.yaml:10: `distortion_coefficients` has 5 numbers for 1 x 4\n"
            "  rows times cols must be the number of data");
  EXPECT_EQ(told(camera_info("a", "plumb_bob", "[0, 0, 0, 0, 0]", 5, 2 * none, 0)),
            "a.yaml:14: `rectification_matrix` is not orthonormal\n"
            "  a rotation has orthonormal rows and determinant +1 (within 1e-4)");
  EXPECT_EQ(told("image_width: [640\n"),
            "a.yaml:1: the file ends early: `[` of line 1 is not closed\n"
            "  copy the whole file again");
  write_text(folder / "b.yaml", fisheye);
  write_text(folder / "c.yaml", fisheye);
  EXPECT_EQ(complaint(folder.path(),
                      [&] {
                        import_from("ros", {folder / "b.yaml", folder / "c.yaml"});
                      }),
            "c.yaml: `wide` and `wide` stand at one place\n"
            "  calibrate them as a pair: then the fourth column of the second's projection_matrix "
            "tells the distance");
}

std::string rows_of(const Pose& pose) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector4d row;
    row << pose.R.row(i).transpose(), pose.t[i];
    text += "  - " + list(row.transpose()) + "\n";
  }
  return text + "  - [0.0, 0.0, 0.0, 1.0]\n";
}

std::string chain(const Pose& second, const Pose& third) {
  return "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n"
         "  distortion_coeffs: [-0.2, 0.1, 0.001, -0.002]\n  distortion_model: radtan\n"
         "  intrinsics: [461.6, 460.2, 362.7, 246.0]\n  resolution: [752, 480]\n"
         "  rostopic: /cam0/image_raw\n"
         "cam1:\n  T_cn_cnm1:\n" +
         rows_of(second) +
         "  camera_model: pinhole\n  distortion_coeffs: [0.02, -0.01, 0.004, -0.001]\n"
         "  distortion_model: equidistant\n  intrinsics: [400.5, 401.5, 360.0, 240.0]\n"
         "  resolution: [752, 480]\n"
         "cam2:\n  T_cn_cnm1:\n" +
         rows_of(third) +
         "  camera_model: pinhole\n  distortion_coeffs: []\n  distortion_model: none\n"
         "  intrinsics: [500.0, 501.0, 330.0, 250.0]\n  resolution: [640, 480]\n";
}

TEST(KalibrImport, AChainProjectsAsItsDocumentSays) {
  const TemporaryFolder folder;
  const Pose second{turn({0, 1, 0.2}, 0.3), {-0.11, 0.01, 0.02}},
      third{turn({1, 0, 0.2}, -0.2), {0.05, 0.2, -0.01}};
  write_text(folder / "camchain.yaml", chain(second, third));
  EXPECT_EQ(recognise({folder / "camchain.yaml"}).name(), "kalibr");
  const Imported imported = import_from("kalibr", {folder / "camchain.yaml"});
  expect_projects(imported, "cam0", {}, [](const Vector3d& x) {
    const Vector2d p = brown(x, {-0.2, 0.1, 0.001, -0.002});
    return Vector2d(461.6 * p.x() + 362.7, 460.2 * p.y() + 246.0);
  });
  expect_projects(imported, "cam1", second, [](const Vector3d& x) {
    const Vector2d p = equidistant(x, {0.02, -0.01, 0.004, -0.001});
    return Vector2d(400.5 * p.x() + 360.0, 401.5 * p.y() + 240.0);
  });
  expect_projects(imported, "cam2", {third.R * second.R, third.R * second.t + third.t},
                  [](const Vector3d& x) {
                    return Vector2d(500 * x.x() / x.z() + 330, 501 * x.y() / x.z() + 250);
                  });
}

TEST(KalibrImport, FaultsHaveTheirLine) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& from, const std::string& to) {
    std::string text = chain({}, {Matrix3d::Identity(), {0.1, 0, 0}});
    text.replace(text.find(from), from.size(), to);
    write_text(folder / "a.yaml", text);
    return complaint(folder.path(), [&] { import_from("kalibr", {folder / "a.yaml"}); });
  };
  EXPECT_EQ(told("camera_model: pinhole", "camera_model: omni"),
            "a.yaml:3:17: camera_model of `cam0` is `omni`\n"
            "  pinhole is read: calibrate with --models pinhole-radtan or pinhole-equi");
  EXPECT_EQ(told("radtan", "fov"),
            "a.yaml:5:21: distortion_model of `cam0` is `fov`\n"
            "  radtan, equidistant or none is expected");
  EXPECT_EQ(told("[461.6, 460.2, 362.7, 246.0]", "[461.6, 460.2]"),
            "a.yaml:6:15: intrinsics of `cam0` is a list of 2\n  4 numbers are expected");
  EXPECT_EQ(told("[1, 0, 0, 0]", "[2, 0, 0, 0]"),
            "a.yaml:11:3: T_cn_cnm1 of `cam1` is not orthonormal\n"
            "  a rotation has orthonormal rows and determinant +1 (within 1e-4)");
  EXPECT_EQ(told("cam1:\n  T_cn_cnm1:", "cam1:\n  T_cam_imu:"),
            "a.yaml:10:3: `cam1` lacks `T_cn_cnm1`\n  the whole camchain as Kalibr wrote it");
  EXPECT_EQ(told("cam0:", "camera:"),
            "a.yaml:1:1: there is no `cam0`\n  a camchain begins with `cam0:`");
}

}  // namespace
}  // namespace hookeye::test
