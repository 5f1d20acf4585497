#include "estimation/model/camera_calibration.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "capture_io/camera_covariance.h"

namespace hookeye {
namespace {

constexpr std::array<const char*, kCalibratedNumbers> kShort = {"rx", "ry", "rz",  "tx",
                                                                "ty", "tz", "zoom"};
constexpr std::array<const char*, kCalibratedNumbers> kLong = {
    "rotation about x", "rotation about y", "rotation about z", "shift along x",
    "shift along y",    "shift along z",    "focal length"};

class CameraCalibration final : public Ingredient {
 public:
  CameraCalibration(std::vector<std::string> cameras, Eigen::MatrixXd root)
      : cameras_(std::move(cameras)), root_(std::move(root)) {}
  std::string name() const override { return "camera_calibration"; }
  std::vector<Parameter> parameters() const override {
    std::vector<Parameter> all;
    for (const std::string& camera : cameras_)
      for (size_t i = 0; i < kShort.size(); ++i) {
        Parameter parameter;
        parameter.name = fmt::format("calibration.{}.{}", camera, kShort[i]);
        parameter.unit = "sigma";
        parameter.long_name = fmt::format("{} of camera '{}'", kLong[i], camera);
        all.push_back(std::move(parameter));
      }
    return all;
  }
  Touches touches() const override { return {.photos = true, .measured = true, .cameras = true}; }

  void apply(const VectorXd& values, Model& model) const override {
    model.calibration = values;
    if (values.isZero(0.0)) return;
    const VectorXd numbers = root_ * values;
    for (ExampleModel& example : model.examples)
      for (PhotoState& photo : example.photos) {
        const auto at = std::ranges::find(cameras_, photo.camera.name);
        if (at == cameras_.end()) continue;
        const auto own =
            numbers.segment<kCalibratedNumbers>(kCalibratedNumbers * (at - cameras_.begin()));
        if (own.isZero(0.0)) continue;
        photo.camera = photo.camera.moved(own.head<3>(), own.segment<3>(3)).zoomed(own[6]);
      }
  }

 private:
  std::vector<std::string> cameras_;
  Eigen::MatrixXd root_;
};

/// Vertices of the surface, few enough.
Matrix3Xd points_to_see(const Scene& scene) {
  constexpr Eigen::Index kMost = 400;
  const Matrix3Xd& X = scene.body->surface.mesh.X;
  const Eigen::Index step = 1 + X.cols() / kMost;
  Matrix3Xd out(3, (X.cols() + step - 1) / step);
  for (Eigen::Index k = 0; k < out.cols(); ++k) out.col(k) = X.col(k * step);
  return out;
}

/// Where one of a camera's numbers stands among its seven, or among its intrinsics as -1 - i.
int place_of(const std::string& name, const Camera& camera) {
  static const std::array<std::string, 6> own = {"rotation_x", "rotation_y", "rotation_z",
                                                 "shift_x",    "shift_y",    "shift_z"};
  const auto at = std::ranges::find(own, name);
  if (at != own.end()) return static_cast<int>(at - own.begin());
  const auto intrinsics = camera.intrinsics();
  return -1 - static_cast<int>(std::ranges::find(intrinsics, name, &Intrinsic::name) -
                               intrinsics.begin());
}

/// Lower triangle of a covariance that may know a number from those before it.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& C) {
  constexpr double kKnown = 1e-10;  // of a variance: that of rounding
  const Eigen::Index n = C.rows();
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double left = C(k, k) - L.row(k).head(k).squaredNorm();
    if (!(left > kKnown * C(k, k))) continue;
    L(k, k) = std::sqrt(left);
    for (Eigen::Index i = k + 1; i < n; ++i)
      L(i, k) = (C(i, k) - L.row(i).head(k).dot(L.row(k).head(k))) / L(k, k);
  }
  return L;
}

/// An example measures the cameras.
bool is_calibrated(const Scene& scene) {
  const auto measures = [](const MeasuredSpec& one) {
    return one.kind == MeasuredSpec::Kind::calibration;
  };
  return scene.capture.camera_covariance &&
         std::ranges::any_of(scene.capture.examples, [&](const ExampleSpec& example) {
           return std::ranges::any_of(example.measured, measures);
         });
}

}  // namespace

Eigen::MatrixXd as_motion(const Camera& camera, const Matrix3Xd& X) {
  constexpr double kShown = 0.01;
  const auto size = static_cast<Eigen::Index>(camera.intrinsics().size());
  Eigen::MatrixXd by_motion(2 * X.cols(), kCalibratedNumbers), by_number(2 * X.cols(), size);
  Eigen::Index rows = 0;
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    Camera::Jacobian7 d;
    const Vector2d pixel = camera.project(X.col(k), nullptr, &d);
    if (!pixel.allFinite()) continue;
    by_motion.middleRows(rows, 2) = d;
    by_number.middleRows(rows, 2) = camera.d_dintrinsics(X.col(k));
    rows += 2;
  }
  if (rows == 0) return Eigen::MatrixXd::Zero(kCalibratedNumbers, size);
  const VectorXd unit = by_motion.topRows(rows).colwise().norm().cwiseMax(1e-300).cwiseInverse();
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(by_motion.topRows(rows) * unit.asDiagonal(),
                                        Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kShown);
  return unit.asDiagonal() * svd.solve(by_number.topRows(rows));
}

Eigen::MatrixXd calibration_root(const Scene& scene) {
  const CameraCovariance& told = *scene.capture.camera_covariance;
  const auto cameras = told.cameras();
  const Matrix3Xd X = points_to_see(scene);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(
      static_cast<Eigen::Index>(kCalibratedNumbers * cameras.size()), told.values.rows());
  for (size_t c = 0; c < cameras.size(); ++c) {
    // The covariance is of the photo as it was taken.
    const Camera camera =
        scene.capture.camera(cameras[c]).resized(std::exp2(scene.halvings_of(cameras[c])));
    const Eigen::MatrixXd motion = as_motion(camera, X);
    for (size_t i = 0; i < told.numbers.size(); ++i) {
      if (told.numbers[i].camera != cameras[c]) continue;
      const int at = place_of(told.numbers[i].name, camera);
      auto column = A.block<kCalibratedNumbers, 1>(
          static_cast<Eigen::Index>(kCalibratedNumbers * c), static_cast<Eigen::Index>(i));
      if (at >= 0)
        column[at] = 1.0;
      else
        column = motion.col(-1 - at);
    }
  }
  return root_of(A * told.values * A.transpose());
}

std::shared_ptr<const Ingredient> calibration_ingredient(const Scene& scene) {
  if (!is_calibrated(scene)) return nullptr;
  return std::make_shared<CameraCalibration>(scene.capture.camera_covariance->cameras(),
                                             calibration_root(scene));
}

VectorXd OffCalibration::seen(const VectorXd& numbers, Model& model) const {
  if (deviations.size() == 0 || model.calibration.size() != deviations.rows()) return numbers;
  model.calibration -= deviations * numbers;
  return beyond * numbers;
}

OffCalibration off_calibration(const Scene& scene, const std::string& camera) {
  OffCalibration out;
  if (!is_calibrated(scene)) return out;
  const auto cameras = scene.capture.camera_covariance->cameras();
  const auto at = std::ranges::find(cameras, camera);
  if (at == cameras.end()) return out;
  const Eigen::Index first = kCalibratedNumbers * (at - cameras.begin());
  const Eigen::MatrixXd root = calibration_root(scene);
  // Turns and lengths in units of what is known of each.
  VectorXd unit = root.rowwise().norm();
  for (double& one : unit)
    if (one == 0.0) one = 1.0;
  const Eigen::MatrixXd scaled = unit.cwiseInverse().asDiagonal() * root;
  const Eigen::MatrixXd inverse = scaled.completeOrthogonalDecomposition().pseudoInverse();
  out.deviations =
      (inverse * unit.cwiseInverse().asDiagonal()).middleCols<kCalibratedNumbers>(first);
  out.beyond -= (root * out.deviations).middleRows<kCalibratedNumbers>(first);
  const auto own = unit.segment<kCalibratedNumbers>(first);
  constexpr double kRounding = 1e-6;
  for (Eigen::Index k = 0; k < own.size(); ++k)
    if (own[k] * out.beyond.col(k).cwiseQuotient(own).norm() < kRounding)
      out.beyond.col(k).setZero();
  return out;
}

}  // namespace hookeye
