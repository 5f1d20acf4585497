#include "capture_io/camera.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <random>

#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Camera make_camera(size_t coefficients) {
  Camera camera;
  camera.name = "test";
  camera.width = 800, camera.height = 600;
  camera.fx = 900, camera.fy = 950, camera.cx = 402.5, camera.cy = 295.25;
  const std::vector<double> all{-0.21, 0.08,  0.0012, -0.0021, 0.011, 0.02,   -0.013,
                                0.004, 0.003, -0.002, 0.0015,  0.001, 0.0311, -0.0217};
  camera.distortion.assign(all.begin(), all.begin() + static_cast<long>(coefficients));
  camera.R = (Eigen::AngleAxisd(0.3, Vector3d(1, 2, -1).normalized())).toRotationMatrix();
  camera.t = {4, -7, 310};
  return camera;
}

std::vector<Vector3d> points_in_view() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> side(-70, 70);
  std::vector<Vector3d> points;
  for (int i = 0; i < 40; ++i) points.emplace_back(side(random), side(random), side(random));
  return points;
}

class EveryDistortion : public testing::TestWithParam<int> {};

TEST_P(EveryDistortion, ProjectsAsOpenCv) {
  const Camera camera = make_camera(GetParam());
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Matx33d r(camera.R(0, 0), camera.R(0, 1), camera.R(0, 2), camera.R(1, 0),
                      camera.R(1, 1), camera.R(1, 2), camera.R(2, 0), camera.R(2, 1),
                      camera.R(2, 2));
  cv::Mat rotation;
  cv::Rodrigues(r, rotation);
  std::vector<cv::Point3d> points;
  for (const Vector3d& x : points_in_view()) points.emplace_back(x.x(), x.y(), x.z());
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, rotation, cv::Vec3d(camera.t.x(), camera.t.y(), camera.t.z()), k,
                    camera.distortion, pixels);
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector2d ours = camera.project(points_in_view()[i]);
    EXPECT_NEAR(ours.x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(ours.y(), pixels[i].y, 1e-9);
  }
}

TEST_P(EveryDistortion, DerivativesAgreeWithDifferences) {
  const Camera camera = make_camera(GetParam());
  for (const Vector3d& x : points_in_view()) {
    Camera::Jacobian3 d_dx;
    Camera::Jacobian7 d_dcamera;
    camera.project(x, &d_dx, &d_dcamera);
    for (int i = 0; i < 3; ++i) {
      const Vector3d e = Vector3d::Unit(i);
      test::expect_derivative(
          [&](double h) -> Eigen::VectorXd { return camera.project(x + h * e); }, d_dx.col(i), 0.05,
          1e-8, "by the point");
      test::expect_derivative(
          [&](double h) -> Eigen::VectorXd {
            return camera.moved(h * e, Vector3d::Zero()).project(x);
          },
          d_dcamera.col(i), 1e-3, 1e-7, "by the rotation");
      test::expect_derivative(
          [&](double h) -> Eigen::VectorXd {
            return camera.moved(Vector3d::Zero(), h * e).project(x);
          },
          d_dcamera.col(3 + i), 0.05, 1e-8, "by the translation");
    }
    test::expect_derivative(
        [&](double h) -> Eigen::VectorXd { return camera.zoomed(h).project(x); }, d_dcamera.col(6),
        1e-3, 1e-8, "by the focal length");
  }
}

TEST_P(EveryDistortion, RayIsTheInverse) {
  const Camera camera = make_camera(GetParam());
  for (double u = 0; u < camera.width; u += 79.9)
    for (double v = 0; v < camera.height; v += 59.9) {
      const Ray ray = camera.ray({u, v});
      EXPECT_NEAR(ray.direction.norm(), 1, 1e-14);
      const Vector2d back = camera.project(ray.origin + 250 * ray.direction);
      EXPECT_NEAR(back.x(), u, 1e-9);
      EXPECT_NEAR(back.y(), v, 1e-9);
    }
}

INSTANTIATE_TEST_SUITE_P(Coefficients, EveryDistortion, testing::Values(0, 4, 5, 8, 12, 14));

TEST(CameraTest, OrthographicIsAScaling) {
  Camera camera = make_camera(0);
  camera.projection = Camera::Projection::orthographic;
  camera.fx = camera.fy = 3;
  camera.R.setIdentity();
  camera.t = {1, 2, -500};  // behind: no matter
  const Vector2d pixel = camera.project(Vector3d(10, 20, 30));
  EXPECT_DOUBLE_EQ(pixel.x(), 3 * 11 + camera.cx);
  EXPECT_DOUBLE_EQ(pixel.y(), 3 * 22 + camera.cy);
  const Ray ray = camera.ray(pixel);
  EXPECT_TRUE(ray.direction.isApprox(Vector3d::UnitZ()));
  EXPECT_TRUE(camera.project(ray.origin + 77 * ray.direction).isApprox(pixel));
}

TEST(CameraTest, OrthographicDerivativesAgreeWithDifferences) {
  Camera camera = make_camera(0);
  camera.projection = Camera::Projection::orthographic;
  camera.fx = 3, camera.fy = 4;
  const Vector3d x(10, 20, 30);
  Camera::Jacobian3 d_dx;
  Camera::Jacobian7 d_dcamera;
  camera.project(x, &d_dx, &d_dcamera);
  for (int i = 0; i < 3; ++i) {
    const Vector3d e = Vector3d::Unit(i);
    test::expect_derivative([&](double h) -> Eigen::VectorXd { return camera.project(x + h * e); },
                            d_dx.col(i), 0.05, 1e-9);
    test::expect_derivative(
        [&](double h) -> Eigen::VectorXd {
          return camera.moved(h * e, Vector3d::Zero()).project(x);
        },
        d_dcamera.col(i), 1e-3, 1e-8);
  }
  // Moving along the axis leaves an orthographic picture as it is.
  EXPECT_EQ(d_dcamera.col(5).norm(), 0);
  test::expect_derivative([&](double h) -> Eigen::VectorXd { return camera.zoomed(h).project(x); },
                          d_dcamera.col(6), 1e-3, 1e-8);
}

TEST(CameraTest, PointsBehindAreNotNumbers) {
  Camera camera = make_camera(5);
  EXPECT_TRUE(camera.project(camera.centre() - camera.R.row(2).transpose()).hasNaN());
  camera.R.setIdentity();
  EXPECT_TRUE(camera.project(-camera.t).hasNaN());
}

TEST(CameraTest, CentreIsWhereRaysMeet) {
  const Camera camera = make_camera(8);
  EXPECT_TRUE(camera.ray({0, 0}).origin.isApprox(camera.centre()));
  EXPECT_NEAR((camera.R * camera.centre() + camera.t).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace hookeye
