// Cameras that are known as well as their calibration tells.
#include "estimation/model/camera_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "capture_io/camera_covariance.h"
#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/evaluation/evaluation.h"

namespace hookeye::test {
namespace {

const char* const kMotions[] = {"rotation_x", "rotation_y", "rotation_z",
                                "shift_x",    "shift_y",    "shift_z"};

/// The block, its cameras known to `deviations` of the numbers of that name, half of each shared
/// with the next.
std::shared_ptr<Scene> known_block(const std::vector<std::pair<std::string, double>>& deviations,
                                   std::shared_ptr<const Scene> of = block_scene()) {
  auto scene = std::make_shared<Scene>(*of);
  CameraCovariance known;
  std::vector<double> all;
  for (const Camera& camera : scene->capture.cameras)
    for (const auto& [name, deviation] : deviations) {
      known.numbers.push_back({camera.name, name});
      all.push_back(deviation);
    }
  const Eigen::Map<VectorXd> sigma(all.data(), static_cast<Eigen::Index>(all.size()));
  Eigen::MatrixXd mix = Eigen::MatrixXd::Identity(sigma.size(), sigma.size());
  mix.diagonal(-1).setConstant(0.5);
  known.values = sigma.asDiagonal() * mix * mix.transpose() * sigma.asDiagonal();
  scene->capture.camera_covariance = std::make_shared<const CameraCovariance>(known);
  measure_calibration(scene->capture);
  return scene;
}

std::vector<std::pair<std::string, double>> motions() {
  std::vector<std::pair<std::string, double>> out;
  for (const char* name : kMotions) out.emplace_back(name, name[0] == 'r' ? 0.002 : 0.3);
  return out;
}

/// What the points' pictures differ by, as one vector [px].
VectorXd apart(const Camera& a, const Camera& b, const Matrix3Xd& X) {
  VectorXd out(2 * X.cols());
  for (Eigen::Index k = 0; k < X.cols(); ++k)
    out.segment<2>(2 * k) = a.project(X.col(k)) - b.project(X.col(k));
  return out;
}

/// Centre, focal length and lens off by a little: the motion that stands for them shows the body
/// where they do, but for what no motion can show.
TEST(CameraCalibration, AMotionStandsForTheOtherNumbers) {
  const auto scene = block_scene();
  const Matrix3Xd& X = scene->body->surface.mesh.X;
  Camera camera = scene->capture.cameras.front();
  camera.distortion = {-0.08, 0.03, 0.001, -0.0005, 0.01};
  const Eigen::MatrixXd as = as_motion(camera, X);
  const auto numbers = camera.intrinsics();
  ASSERT_EQ(as.cols(), static_cast<Eigen::Index>(numbers.size()));
  for (const char* name : {"cx", "cy", "fx"}) {
    Camera off = camera;
    const double h = 0.02;
    Eigen::Index at = 0;
    while (numbers[static_cast<size_t>(at)].name != name) ++at;
    (at == 0 ? off.fx : at == 2 ? off.cx : off.cy) += h;
    if (at == 0) off.fy += h * camera.fy / camera.fx;  // a longer focal length along both
    const VectorXd column =
        at == 0 ? VectorXd(as.col(0) + as.col(1) * camera.fy / camera.fx) : VectorXd(as.col(at));
    const Camera moved =
        camera.moved(h * column.head<3>(), h * column.segment<3>(3)).zoomed(h * column[6]);
    const double whole = apart(off, camera, X).norm();
    ASSERT_GT(whole, 0.0);
    EXPECT_LT(apart(off, moved, X).norm(), 0.02 * whole) << name;
  }
}

/// Drawn numbers of the covariance and drawn numbers of the model move pictures alike: the same
/// variances and correlations of where points are seen.
TEST(CameraCalibration, ItsRootHasTheToldCovariance) {
  auto deviations = motions();
  deviations.insert(deviations.end(), {{"fx", 0.4}, {"fy", 0.4}, {"cx", 0.6}, {"cy", 0.6}});
  const auto scene = known_block(deviations);
  const Eigen::MatrixXd L = calibration_root(*scene);
  const CameraCovariance& known = *scene->capture.camera_covariance;
  ASSERT_EQ(L.rows(), 14);
  EXPECT_TRUE(L.isLowerTriangular());
  const Matrix3Xd X = scene->body->surface.mesh.X.leftCols(40);
  Eigen::MatrixXd by_numbers(160, known.values.rows()), by_model(160, 14);
  by_numbers.setZero(), by_model.setZero();
  for (Eigen::Index c = 0; c < 2; ++c) {
    const Camera& camera = scene->capture.cameras[static_cast<size_t>(c)];
    const Eigen::Index each = known.values.rows() / 2;
    for (Eigen::Index k = 0; k < 40; ++k) {
      Camera::Jacobian7 d;
      camera.project(X.col(k), nullptr, &d);
      const Eigen::Index row = 80 * c + 2 * k;
      by_model.block<2, 7>(row, 7 * c) = d;
      by_numbers.block<2, 6>(row, each * c) = d.leftCols<6>();
      by_numbers.block<2, 4>(row, each * c + 6) = camera.d_dintrinsics(X.col(k)).leftCols(4);
    }
  }
  const Eigen::MatrixXd told = by_numbers * known.values * by_numbers.transpose();
  const Eigen::MatrixXd made = by_model * L * L.transpose() * by_model.transpose();
  EXPECT_LT((told - made).norm(), 0.05 * told.norm());
  EXPECT_GT(told.topRightCorner(80, 80).norm(), 0.02 * told.norm()) << "the cameras are correlated";
}

TEST(CameraCalibration, AtNoDeviationTheModelIsAsToldAndElsewhereItsCamerasMove) {
  const auto scene = known_block(motions());
  const ModelForm form = base_form(scene);
  ASSERT_EQ(form.size(), base_form(block_scene()).size() + 14);
  VectorXd p = form.initial();
  EXPECT_TRUE(p.tail(14).isZero(0.0));
  const Model told = form.realise(p), plain = base_form(block_scene()).realise(p.head(1));
  for (size_t e = 0; e < told.examples.size(); ++e)
    for (size_t k = 0; k < told.examples[e].photos.size(); ++k)
      EXPECT_EQ(photo_difference(told.examples[e].photos[k], plain.examples[e].photos[k]).norm(),
                0);
  p.tail(14).setLinSpaced(-1.0, 1.5);
  const Model off = form.realise(p);
  const VectorXd numbers = calibration_root(*scene) * p.tail(14);
  const PhotoState &before = plain.examples[1].photos[1], &after = off.examples[1].photos[1];
  EXPECT_EQ(before.camera.name, scene->capture.cameras[1].name);
  const VectorXd moved = photo_difference(before, after);
  EXPECT_LT((moved.head(7) - numbers.tail(7)).norm(), 1e-6 * numbers.norm());
}

/// The calibration is met to the deviations that the model has, and pulls it back.
TEST(CameraCalibration, ItIsAMeasurementOfTheDeviations) {
  const auto scene = known_block(motions());
  const ModelForm form = base_form(scene);
  VectorXd p = form.initial();
  p.tail(14).setLinSpaced(-2.0, 3.0);
  Workspace workspace(scene);
  const Evaluation seen = workspace.evaluate(form, p, {}).value();
  const MeasuredEvaluation& one = seen.examples.at(0).measured.back();
  EXPECT_LT((one.r - p.tail(14)).norm(), 1e-12);
  EXPECT_LT((one.J.rightCols(14) - Eigen::MatrixXd::Identity(14, 14)).norm(), 1e-8);
  EXPECT_LT(one.J.leftCols(p.size() - 14).norm(), 1e-12);
}

/// Body, loads and cameras turned as one: the same covariance says the same.
TEST(CameraCalibration, AWorldThatIsTurnedMovesTheSamePixels) {
  const auto scene = known_block(motions());
  auto turned = known_block(motions(), turned_scene());
  for (Camera& camera : turned->capture.cameras) {
    const Eigen::Matrix3d R = camera.R;
    for (int i = 0; i < 3; ++i) camera.R.col(i) = R * quarter_turn(Vector3d::Unit(i));
    camera.R = R * (Matrix3d() << 0, 1, 0, -1, 0, 0, 0, 0, 1).finished();
  }
  EXPECT_LT((calibration_root(*scene) - calibration_root(*turned)).norm(),
            1e-9 * calibration_root(*scene).norm());
}

/// A knocked camera: the numbers of the model meet the photos as they would, and the calibration is
/// not blamed for them.
TEST(CameraCalibration, AKnockIsTakenOffWhatItSees) {
  const auto scene = known_block(motions());
  const ModelForm plain = base_form(scene);
  const Model before = plain.realise(plain.initial());
  const std::string camera = scene->capture.cameras[1].name;
  const auto knock = find_effect("camera_pose")->candidate(before, camera + " from the start");
  ASSERT_TRUE(knock);
  EXPECT_FALSE(knock->touches().photos) << "turns and shifts are all known to some deviation";
  const ModelForm form = extended(plain, knock);
  VectorXd theta(7);
  theta << 0.004, -0.002, 0.006, 0.5, -0.8, 1.2, 0.0;
  VectorXd p = with_values(form, theta.head(6));
  EXPECT_EQ(
      photo_difference(before.examples[0].photos[1], form.realise(p).examples[0].photos[1]).norm(),
      0.0);
  p.segment(p.size() - 20, 14) = off_calibration(*scene, camera).deviations * theta;
  EXPECT_GT(p.segment(p.size() - 20, 14).norm(), 2.0);
  const Model after = form.realise(p);
  EXPECT_LT(after.calibration.norm(), 1e-9);
  const VectorXd moved =
      photo_difference(before.examples[0].photos[1], after.examples[0].photos[1]);
  EXPECT_LT((moved.head(7) - theta).norm(), 1e-6 * theta.norm());
  // The pose of another is exact, as that of the world is: it has to move itself.
  auto given = std::make_shared<Scene>(*scene);
  CameraCovariance known = *given->capture.camera_covariance;
  known.numbers.assign({{camera, "fx"}, {camera, "fy"}});
  known.values = Eigen::MatrixXd::Identity(2, 2);
  given->capture.camera_covariance = std::make_shared<const CameraCovariance>(known);
  given->capture.examples[0].measured.back().value.setZero(7);
  given->capture.examples[0].measured.back().sigma.setOnes(7);
  const Model exact = base_form(given).realise(base_form(given).initial());
  const auto itself = find_effect("camera_pose")->candidate(exact, camera + " from the start");
  EXPECT_TRUE(itself->touches().photos);
  const ModelForm with = extended(base_form(given), itself);
  VectorXd q = with_values(with, theta.head(6));
  q.segment(q.size() - 13, 7) = off_calibration(*given, camera).deviations * theta;
  const VectorXd gone =
      photo_difference(exact.examples[0].photos[1], with.realise(q).examples[0].photos[1]);
  EXPECT_LT((gone.head(7) - theta).norm(), 0.03 * theta.norm()) << "turns and zooms do not commute";
}

/// The camera that is the world has no number of its pose: its columns are dead, not wild.
TEST(CameraCalibration, AGivenPoseStaysWhereItIs) {
  auto scene = known_block(motions());
  CameraCovariance known = *scene->capture.camera_covariance;
  known.numbers.erase(known.numbers.begin(), known.numbers.begin() + 6);
  known.values = known.values.bottomRightCorner(6, 6).eval();
  known.numbers.insert(known.numbers.begin(), {scene->capture.cameras[0].name, "cx"});
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(7, 7);
  all.bottomRightCorner(6, 6) = known.values;
  all(0, 0) = 0.25;
  known.values = all;
  scene->capture.camera_covariance = std::make_shared<const CameraCovariance>(known);
  const Eigen::MatrixXd L = calibration_root(*scene);
  ASSERT_TRUE(L.allFinite());
  int alive = 0;
  for (Eigen::Index i = 0; i < 7; ++i) alive += L.col(i).norm() > 0.0;
  EXPECT_EQ(alive, 1) << "one number is told of it";
}

}  // namespace
}  // namespace hookeye::test
