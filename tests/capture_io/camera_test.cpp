// What every camera of the catalogue promises, and that OpenCV's own projection gives the same.
#include "capture_io/camera.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <random>

#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Numbers that every model takes as many of as it may.
const std::vector<double> kPerspectiveLens{-0.21, 0.08,  0.0012, -0.0021, 0.011, 0.02,   -0.013,
                                           0.004, 0.003, -0.002, 0.0015,  0.001, 0.0311, -0.0217};
const std::vector<double> kFisheyeLens{-0.05, 0.02, -0.008, 0.001};
const std::vector<double> kOrthographicLens{-4e-6, 3e-11, 2e-6, -3e-6, 1e-16, 2e-6,
                                            1e-11, 1e-16, 1e-6, 2e-10, -2e-6, 1e-10};

Camera make_camera(const std::string& model, size_t coefficients, double skew = 0) {
  Camera camera;
  camera.name = "test";
  camera.width = 800, camera.height = 600;
  camera.model = &camera_model(model);
  camera.fx = 900, camera.fy = 950, camera.cx = 402.5, camera.cy = 295.25;
  std::vector<double> all = kPerspectiveLens;
  if (model == "fisheye") all = kFisheyeLens, camera.fx = 370, camera.fy = 385;
  if (model == "orthographic") all = kOrthographicLens, camera.fx = 2, camera.fy = 2.1;
  camera.skew = skew * camera.fx;
  camera.distortion.assign(all.begin(), all.begin() + static_cast<long>(coefficients));
  camera.R = (Eigen::AngleAxisd(0.3, Vector3d(1, 2, -1).normalized())).toRotationMatrix();
  camera.t = {4, -7, 310};
  return camera;
}

/// Some 80 points about the origin; further out before a fisheye, up to 70 degrees off its axis.
std::vector<Vector3d> points_in_view(const Camera& camera) {
  std::mt19937 random(7);
  const bool wide = camera.model->name() == "fisheye";
  std::uniform_real_distribution<double> side(-70, 70), far(-500, 500);
  std::vector<Vector3d> points;
  while (points.size() < 80) {
    const Vector3d x(wide ? far(random) : side(random), wide ? far(random) : side(random),
                     side(random));
    if ((camera.R * x + camera.t).z() > 150) points.push_back(x);
  }
  return points;
}

struct Kind {
  const char* model;
  int coefficients;
  double skew;
};

std::string name_of(const testing::TestParamInfo<Kind>& info) {
  return info.param.model + std::to_string(info.param.coefficients) +
         (info.param.skew != 0 ? "skewed" : "");
}

class EveryCamera : public testing::TestWithParam<Kind> {
 protected:
  const Camera camera =
      make_camera(GetParam().model, static_cast<size_t>(GetParam().coefficients), GetParam().skew);
};

struct OfOpenCv {
  std::vector<cv::Point2d> pixels;
  cv::Mat jacobian;
};

/// cv::projectPoints of a camera matrix diag(fx, fy, 1); it knows no principal point that matters
/// here and no skew.
OfOpenCv projected(const Camera& camera, const std::vector<Vector3d>& world, const cv::Matx33d& K) {
  const Eigen::Matrix3d& R = camera.R;
  cv::Mat rotation;
  cv::Rodrigues(
      cv::Matx33d(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
      rotation);
  std::vector<cv::Point3d> points;
  for (const Vector3d& x : world) points.emplace_back(x.x(), x.y(), x.z());
  const cv::Vec3d t(camera.t.x(), camera.t.y(), camera.t.z());
  OfOpenCv out;
  std::vector<double> lens = camera.distortion;
  if (camera.model->name() == "fisheye") {
    lens.resize(4);
    cv::fisheye::projectPoints(points, out.pixels, cv::Vec3d(rotation), t, K, lens,
                               camera.skew / camera.fx, out.jacobian);
  } else {
    cv::projectPoints(points, rotation, t, K, lens, out.pixels, out.jacobian);
  }
  return out;
}

/// Of cv::projectPoints the picture leans by hand.
Vector2d leaning(const Camera& camera, cv::Point2d pixel) {
  if (camera.model->name() != "fisheye") pixel.x += camera.skew / camera.fy * (pixel.y - camera.cy);
  return {pixel.x, pixel.y};
}

class LikeOpenCv : public EveryCamera {};

TEST_P(LikeOpenCv, Projects) {
  const std::vector<Vector3d> points = points_in_view(camera);
  const OfOpenCv theirs =
      projected(camera, points, {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector2d ours = camera.project(points[i]), other = leaning(camera, theirs.pixels[i]);
    EXPECT_NEAR(ours.x(), other.x(), 1e-9);
    EXPECT_NEAR(ours.y(), other.y(), 1e-9);
  }
}

TEST_P(LikeOpenCv, HasTheSameDerivatives) {
  const bool fisheye = this->camera.model->name() == "fisheye";
  Camera camera = this->camera;
  if (!fisheye) camera.skew = 0;
  const std::vector<Vector3d> points = points_in_view(camera);
  const cv::Mat theirs =
      projected(camera, points, {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1})
          .jacobian;
  // Columns: fisheye f, c, k (4), rotation, translation, alpha; else rotation, translation, f, c,
  // k.
  const int f = fisheye ? 0 : 6, lens = fisheye ? 4 : 10, move = fisheye ? 11 : 3;
  const auto coefficients = static_cast<int>(camera.distortion.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix2Xd ours = camera.d_dintrinsics(points[i]);
    ASSERT_EQ(ours.cols(), 5 + coefficients);
    Camera::Jacobian7 by_camera;
    camera.project(points[i], nullptr, &by_camera);
    for (int row = 0; row < 2; ++row) {
      const double* d = theirs.ptr<double>(static_cast<int>(2 * i) + row);
      for (int k = 0; k < 4; ++k) {
        // Its alpha is skew over fx, which then takes the skew with it.
        const double with_fx = k == 0 && row == 0 ? camera.skew / camera.fx * ours(0, 4) : 0;
        EXPECT_NEAR(ours(row, k) + with_fx, d[f + k], 1e-9);
      }
      for (int k = 0; k < coefficients; ++k)
        EXPECT_NEAR(ours(row, 5 + k), d[lens + k], 1e-8 * (1 + std::abs(d[lens + k])));
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(by_camera(row, 3 + k), d[move + k], 1e-9);
      if (!fisheye) continue;
      EXPECT_NEAR(ours(row, 4) * camera.fx, d[14], 1e-8 * (1 + std::abs(d[14])));
    }
  }
}

TEST_P(EveryCamera, DerivativesByPointAndPoseAgreeWithDifferences) {
  for (const Vector3d& x : points_in_view(camera)) {
    Camera::Jacobian3 d_dx;
    Camera::Jacobian7 d_dcamera;
    EXPECT_EQ(camera.project(x, &d_dx, &d_dcamera), camera.project(x));
    for (int i = 0; i < 3; ++i) {
      const Vector3d e = Vector3d::Unit(i);
      test::expect_derivative([&](double h) -> VectorXd { return camera.project(x + h * e); },
                              d_dx.col(i), 0.05, 1e-8, "by the point");
      test::expect_derivative(
          [&](double h) -> VectorXd { return camera.moved(h * e, Vector3d::Zero()).project(x); },
          d_dcamera.col(i), 1e-3, 1e-7, "by the rotation");
      if (i == 2 && !camera.model->central()) {
        EXPECT_EQ(d_dcamera.col(5).norm(), 0) << "the picture does not change along the axis";
        continue;
      }
      test::expect_derivative(
          [&](double h) -> VectorXd { return camera.moved(Vector3d::Zero(), h * e).project(x); },
          d_dcamera.col(3 + i), 0.05, 1e-8, "by the translation");
    }
    test::expect_derivative([&](double h) -> VectorXd { return camera.zoomed(h).project(x); },
                            d_dcamera.col(6), 1e-3, 1e-8, "by the focal length");
  }
}

TEST_P(EveryCamera, DerivativesByIntrinsicsAgreeWithDifferences) {
  const std::vector<Intrinsic> numbers = camera.intrinsics();
  ASSERT_EQ(numbers.size(), 5 + camera.distortion.size());
  for (const Vector3d& x : points_in_view(camera)) {
    const Eigen::Matrix2Xd d = camera.d_dintrinsics(x);
    for (size_t k = 0; k < numbers.size(); ++k) {
      const auto with = [&](double h) -> VectorXd {
        Camera c = camera;
        double* const own[] = {&c.fx, &c.fy, &c.cx, &c.cy, &c.skew};
        (k < 5 ? *own[k] : c.distortion[k - 5]) += h;
        return c.project(x);
      };
      const auto column = static_cast<Eigen::Index>(k);
      // As far as moves the picture by a tenth of a pixel; all but angles act straight.
      const double step = numbers[k].unit == "rad" ? 1e-3 : 0.1 / d.col(column).norm();
      test::expect_derivative(with, d.col(column), step, 1e-7, "by " + numbers[k].name);
    }
  }
}

TEST_P(EveryCamera, RaysInvertTheProjectionOverTheWholePicture) {
  for (int i = 0; i <= 40; ++i)
    for (int j = 0; j <= 40; ++j) {
      const Vector2d pixel(-0.5 + camera.width * i / 40.0, -0.5 + camera.height * j / 40.0);
      const Ray ray = camera.ray(pixel);
      EXPECT_NEAR(ray.direction.norm(), 1, 1e-14);
      const Vector2d back = camera.project(ray.origin + 250 * ray.direction);
      EXPECT_LT((back - pixel).norm(), 1e-9) << pixel.transpose();
    }
}

/// A short step across the line of sight moves the picture by as much in every direction, where the
/// lens does not bend, and on the geometric mean where it does.
TEST_P(EveryCamera, KnowsWhatAPixelMeasures) {
  Camera plain = camera;
  plain.fy = plain.fx, plain.skew = 0;
  if (camera.model->name() != "fisheye") plain.distortion.clear();
  const Vector3d x = plain.R.transpose() *
                     (Vector3d(camera.model->name() == "fisheye" ? 200 : 0, 0, 250) - plain.t);
  Camera::Jacobian3 d;
  plain.project(x, &d, nullptr);
  const double px_per_length = std::sqrt(std::sqrt((d * d.transpose()).determinant()));
  EXPECT_NEAR(plain.length_per_px(x) * px_per_length, 1, 1e-12);
}

TEST_P(EveryCamera, ResizedSeesTheSamePicture) {
  const Camera half = camera.resized(0.5);
  for (const Vector3d& x : points_in_view(camera)) {
    const Vector2d pixel = camera.project(x);
    EXPECT_LT((half.project(x) - (0.5 * (pixel + Vector2d(0.5, 0.5)) - Vector2d(0.5, 0.5))).norm(),
              1e-10);
  }
}

const auto kOpenCv = testing::Values(
    Kind{"perspective", 0, 0}, Kind{"perspective", 4, 0}, Kind{"perspective", 5, 0},
    Kind{"perspective", 8, 0}, Kind{"perspective", 12, 0}, Kind{"perspective", 14, 0},
    Kind{"perspective", 0, 0.01}, Kind{"perspective", 14, -0.03}, Kind{"fisheye", 0, 0},
    Kind{"fisheye", 4, 0}, Kind{"fisheye", 4, 0.02});
const auto kParallel = testing::Values(Kind{"orthographic", 0, 0}, Kind{"orthographic", 0, 0.01},
                                       Kind{"orthographic", 5, 0}, Kind{"orthographic", 12, -0.02});
INSTANTIATE_TEST_SUITE_P(OpenCv, LikeOpenCv, kOpenCv, name_of);
INSTANTIATE_TEST_SUITE_P(Central, EveryCamera, kOpenCv, name_of);
INSTANTIATE_TEST_SUITE_P(Parallel, EveryCamera, kParallel, name_of);

/// Whoever adds a camera to the catalogue adds it to the tables above.
TEST(CameraModels, AreAllTested) {
  std::vector<std::string> names;
  for (const CameraModel* model : camera_models()) {
    names.push_back(model->name());
    EXPECT_EQ(find_camera_model(model->name()), model);
    EXPECT_TRUE(model->takes(0));
    EXPECT_TRUE(model->takes(model->lens_numbers().size()));
    EXPECT_FALSE(model->takes(model->lens_numbers().size() + 1));
  }
  EXPECT_EQ(names, (std::vector<std::string>{"perspective", "fisheye", "orthographic"}));
  EXPECT_EQ(find_camera_model("pinhole"), nullptr);
  EXPECT_EQ(Camera().model->name(), "perspective");
}

/// A derivative by the tilt of a sensor that is told as upright.
TEST(CameraTest, TiltFromZero) {
  Camera camera = make_camera("perspective", 14);
  camera.distortion[12] = camera.distortion[13] = 0;
  const Vector3d x(30, -40, 10);
  const Eigen::Matrix2Xd d = camera.d_dintrinsics(x);
  for (const int k : {12, 13})
    test::expect_derivative(
        [&](double h) -> VectorXd {
          Camera c = camera;
          c.distortion[static_cast<size_t>(k)] += h;
          return c.project(x);
        },
        d.col(5 + k), 1e-3, 1e-8);
}

TEST(CameraTest, FisheyeOnItsAxis) {
  Camera camera = make_camera("fisheye", 4, 0.02);
  camera.R.setIdentity(), camera.t.setZero();
  for (const double beside : {0.0, 1e-12, 1e-7, 1e-4}) {
    const Vector3d x(beside, -2 * beside, 100);
    Camera::Jacobian3 d;
    const Vector2d pixel = camera.project(x, &d, nullptr);
    EXPECT_NEAR(pixel.y(), camera.cy - camera.fy * 2 * beside / 100, 1e-10);
    EXPECT_NEAR(d(0, 0), camera.fx / 100, 1e-10);
    EXPECT_NEAR(d(1, 1), camera.fy / 100, 1e-10);
    EXPECT_NEAR(d(0, 1), camera.skew / 100, 1e-10);
    EXPECT_LT((camera.project(camera.ray(pixel).direction) - pixel).norm(), 1e-10);
    EXPECT_NEAR(camera.length_per_px(x), 100 / camera.fx, 1e-10);
  }
}

/// Where the polynomial turns back, a point that lies further out has no pixel and no pixel its
/// ray.
TEST(CameraTest, FisheyeEndsWhereItFolds) {
  Camera camera;
  camera.model = &camera_model("fisheye");
  camera.fx = camera.fy = 100;
  camera.distortion = {-0.5, 0, 0, 0};  // r = theta - theta^3 / 2: largest at 0.816, there 0.544
  const auto at = [](double theta) { return Vector3d(std::sin(theta), 0, std::cos(theta)); };
  EXPECT_NEAR(camera.project(at(0.8)).x(), 100 * (0.8 - 0.256), 1e-10);
  EXPECT_TRUE(camera.project(at(0.83)).hasNaN());
  EXPECT_NEAR(camera.ray({54, 0}).direction.x(), std::sin(0.75637), 1e-4);
  EXPECT_TRUE(camera.ray({55, 0}).direction.hasNaN());
  // Beyond 89 degrees.
  camera.distortion.clear();
  EXPECT_FALSE(camera.ray({155, 0}).direction.hasNaN());
  EXPECT_TRUE(camera.ray({156, 0}).direction.hasNaN());
}

TEST(CameraTest, OrthographicIsAScaling) {
  Camera camera = make_camera("orthographic", 0);
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

TEST(CameraTest, PointsBehindAreNotNumbers) {
  for (const char* model : {"perspective", "fisheye"}) {
    Camera camera = make_camera(model, 4);
    EXPECT_TRUE(camera.project(camera.centre() - camera.R.row(2).transpose()).hasNaN());
    EXPECT_TRUE(camera.d_dintrinsics(camera.centre() - camera.R.row(2).transpose()).hasNaN());
    camera.R.setIdentity();
    EXPECT_TRUE(camera.project(-camera.t).hasNaN());
  }
}

TEST(CameraTest, CentreIsWhereRaysMeet) {
  const Camera camera = make_camera("perspective", 8);
  EXPECT_TRUE(camera.ray({0, 0}).origin.isApprox(camera.centre()));
  EXPECT_NEAR((camera.R * camera.centre() + camera.t).norm(), 0, 1e-12);
}

TEST(CameraTest, IsToldAsItIsRead) {
  Camera camera = make_camera("fisheye", 4, 0.02);
  const auto number = [](double x) { return fmt::format("{:.4g}", x); };
  EXPECT_EQ(intrinsics_text(camera, number),
            "{fx: 370, fy: 385, cx: 402.5, cy: 295.2, skew: 7.4, "
            "distortion: [-0.05, 0.02, -0.008, 0.001]}");
  camera.skew = 0, camera.distortion.clear();
  EXPECT_EQ(intrinsics_text(camera, number), "{fx: 370, fy: 385, cx: 402.5, cy: 295.2}");
}

}  // namespace
}  // namespace hookeye
