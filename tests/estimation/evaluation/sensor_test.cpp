// Predictions of sensors against what they are, their derivatives against finite differences.
#include "estimation/evaluation/sensor.h"

#include <gmock/gmock.h>

#include <cmath>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/model/gauges.h"
#include "estimation/model/session_sensors.h"

namespace hookeye::test {
namespace {

using Kind = MeasuredSpec::Kind;

MeasuredSpec told(Kind kind, const Vector3d& direction) {
  MeasuredSpec out;
  out.kind = kind;
  out.region = "grip";
  out.point = {0.0, 0.0, 40.0};
  out.direction = direction;
  out.value = VectorXd::Zero(kind_of(out).size);
  out.sigma = VectorXd::Ones(kind_of(out).size);
  return out;
}

/// The block with every kind of sensor in every example, and no photos.
std::shared_ptr<const Scene> sensed_block() {
  auto scene = std::make_shared<Scene>(*block_scene());
  for (size_t e = 0; e < scene->capture.examples.size(); ++e) {
    scene->photos[e].clear();
    scene->capture.examples[e].photos.clear();
    scene->capture.examples[e].measured = {told(Kind::force_on, Vector3d::Zero()),
                                           told(Kind::moment_on, {1.0, 2.0, 30.0}),
                                           told(Kind::position_of, Vector3d::Zero()),
                                           told(Kind::travel_of, Vector3d(1, 2, 2) / 3.0),
                                           told(Kind::rotation_of, Vector3d(2, 1, 2) / 3.0),
                                           told(Kind::strain_of, {3.0, -2.0, 12.5})};
  }
  return scene;
}

/// travel_of along a direction, as a sensor that a program adds.
class AddedTravel final : public SessionSensor {
 public:
  explicit AddedTravel(const Vector3d& along) : along_(along) {}
  std::string name() const override { return "added_travel"; }
  std::string unit() const override { return "mm"; }
  std::vector<std::string> regions() const override { return {"grip"}; }
  Matrix3Xd points() const override { return {}; }
  SensorAnswer answer(const SensedMotion& motion) const override {
    const Eigen::Index n = motion.u.size() / 3;
    Eigen::RowVectorXd mean(3 * n);
    for (Eigen::Index i = 0; i < n; ++i)
      mean.segment<3>(3 * i) = along_.transpose() / static_cast<double>(n);
    return {mean * motion.u, mean * motion.du};
  }

 private:
  Vector3d along_;
};

/// position_of a point, and how far it went: two numbers of different kinds.
class AddedPoint final : public SessionSensor {
 public:
  std::string name() const override { return "added_point"; }
  std::string unit() const override { return "mm"; }
  std::vector<std::string> regions() const override { return {}; }
  Matrix3Xd points() const override { return Vector3d(0.0, 0.0, 40.0); }
  SensorAnswer answer(const SensedMotion& motion) const override { return {motion.x, motion.dx}; }
};

MeasuredSpec told_by(const std::string& sensor, int size) {
  MeasuredSpec out = told(Kind::sensor, Vector3d::Zero());
  out.region = sensor;
  out.value = VectorXd::Zero(size), out.sigma = VectorXd::Ones(size);
  return out;
}

TEST(Sensor, OneThatAProgramAddsIsTheOneBuiltIn) {
  const Vector3d along = Vector3d(1, 2, 2) / 3.0;
  add_sensor(std::make_shared<AddedTravel>(along), "1");
  add_sensor(std::make_shared<AddedPoint>(), "2");
  EXPECT_THAT(added_sensors(), testing::ElementsAre("added_point 2", "added_travel 1"));
  auto scene = std::make_shared<Scene>(*block_scene());
  for (size_t e = 0; e < scene->capture.examples.size(); ++e) {
    scene->photos[e].clear();
    scene->capture.examples[e].photos.clear();
    scene->capture.examples[e].measured = {told(Kind::travel_of, along), told_by("added_travel", 1),
                                           told(Kind::position_of, Vector3d::Zero()),
                                           told_by("added_point", 3)};
    EXPECT_NO_THROW(check_sensors(scene->capture, scene->capture.examples[e]));
  }
  const std::shared_ptr<const Scene> whole = scene;
  ModelForm form = base_form(whole);
  form.ingredients.push_back(
      find_effect("placement")->candidates(form.realise(form.initial()), nullptr).front());
  VectorXd p = form.initial();
  p.tail(6).setConstant(0.01);
  Workspace workspace(whole);
  const auto here = workspace.evaluate(form, p, {}).value();
  double most = 0.0;
  for (const ExampleEvaluation& example : here.examples)
    for (size_t k = 0; k < 4; k += 2) {
      const MeasuredEvaluation &built_in = example.measured[k], &added = example.measured[k + 1];
      EXPECT_LT((built_in.predicted - added.predicted).norm(), 1e-12);
      EXPECT_LT((built_in.J - added.J).norm(), 1e-12 * built_in.J.norm());
      most = std::max(most, built_in.J.norm());
    }
  EXPECT_GT(most, 0.0);
  EXPECT_TRUE(take_sensor("added_point"));
  EXPECT_FALSE(take_sensor("added_point"));
  EXPECT_THROW(check_sensors(scene->capture, scene->capture.examples[0]), InputError);
  EXPECT_TRUE(take_sensor("added_travel"));
}

TEST(Sensor, DerivativesAreThoseOfFiniteDifferences) {
  const auto scene = sensed_block();
  ModelForm form = base_form(scene);
  for (const char* name : {"gravity", "placement"})
    form.ingredients.push_back(
        find_effect(name)->candidates(form.realise(form.initial()), nullptr).front());
  VectorXd p = form.initial();
  p.segment<3>(1) = Vector3d(3000.0, -2000.0, -9000.0);
  p.tail(form.size() - 4).setConstant(0.01);
  Workspace workspace(scene);
  const auto at = [&](const VectorXd& there) {
    return workspace.evaluate(form, there, {}).value();
  };
  const Evaluation here = at(p);
  const auto parameters = form.parameters();
  for (int i = 0; i < p.size(); ++i) {
    VectorXd step = VectorXd::Zero(p.size());
    step[i] = 1e-3 * (parameters[i].positive ? p[i] : parameters[i].typical);
    const Evaluation up = at(p + step), down = at(p - step);
    for (size_t e = 0; e < here.examples.size(); ++e)
      for (size_t k = 0; k < here.examples[e].measured.size(); ++k) {
        const auto& one = here.examples[e].measured[k];
        const VectorXd difference =
            (up.examples[e].measured[k].predicted - down.examples[e].measured[k].predicted) /
            (2.0 * step[i]);
        const double scale = one.J.norm() * 1e-4 + difference.norm();
        EXPECT_LT((one.J.col(i) - difference).norm(), 2e-3 * scale + 1e-9)
            << parameters[i].name << " of sensor " << k << " in example " << e;
      }
  }
}

/// A region that moves as a rigid body tells that motion, whatever else the body does.
TEST(Sensor, ARigidJawTellsItsTravelAndItsTurn) {
  const auto scene = sensed_block();
  const Region& grip = scene->body->regions.at("grip");
  const Matrix3Xd& X = scene->body->mesh.X;
  ModelForm form = base_form(scene);
  const Model model = form.realise(form.initial());
  const Vector3d axis = Vector3d(2, 1, 2) / 3.0, move(0.5, -0.3, 2.0);
  for (const double degrees : {-170.0, -20.0, 0.0, 3.0, 90.0, 400.0}) {
    Equilibrium state;
    state.q = X.reshaped();
    const Eigen::Isometry3d motion =
        Eigen::Translation3d(move) * Eigen::AngleAxisd(degrees * M_PI / 180.0, axis);
    for (const int node : grip.nodes) state.q.segment<3>(3 * node) = motion * X.col(node);
    const Eigen::MatrixXd none;
    const Sensed seen{*scene, model, 0, state, none};
    MeasuredSpec turn = told(Kind::rotation_of, axis);
    turn.value[0] = degrees + 100.0;  // the machine counts whole turns
    EXPECT_NEAR(predicted(turn, seen).value[0], degrees, 1e-9);
  }
  Equilibrium state;
  state.q = (X.colwise() + move).reshaped();
  const Eigen::MatrixXd none;
  EXPECT_NEAR(predicted(told(Kind::travel_of, axis), {*scene, model, 0, state, none}).value[0],
              axis.dot(move), 1e-12);
}

/// Wherever in the body its ends lie: of a body that is stretched alike everywhere, and turned.
TEST(Sensor, AGaugeTellsTheStrainAlongIt) {
  const auto scene = sensed_block();
  const Matrix3Xd& X = scene->body->mesh.X;
  const Model model = base_form(scene).realise(base_form(scene).initial());
  const Eigen::AngleAxisd turn(0.8, Vector3d(1, 2, 2) / 3.0);
  const Vector3d stretch(0.95, 0.9, 1.25);
  Equilibrium state;
  const Matrix3Xd stretched = turn.toRotationMatrix() * stretch.asDiagonal() * X;
  state.q = stretched.reshaped();
  const Eigen::MatrixXd none;
  const Sensed seen{*scene, model, 0, state, none};
  MeasuredSpec gauge = told(Kind::strain_of, {0.0, 0.0, 10.0});  // from z = 40
  EXPECT_NEAR(predicted(gauge, seen).value[0], 0.25, 1e-9);
  gauge.point = {-6.0, 1.0, 17.0}, gauge.direction = {7.0, 1.0, 17.0};
  EXPECT_NEAR(predicted(gauge, seen).value[0], -0.05, 1e-9);
  gauge.direction = {-1.0, 3.0, 28.0};
  const Vector3d along = gauge.direction - gauge.point;
  EXPECT_NEAR(predicted(gauge, seen).value[0],
              (stretch.asDiagonal() * along).norm() / along.norm() - 1.0, 1e-9);
  EXPECT_EQ(unit_of(gauge, scene->capture.units), "");
}

TEST(Sensor, AGaugeOutsideOfTheBodyIsRefused) {
  const auto scene = sensed_block();
  ExampleSpec example = scene->capture.examples.at(0);
  check_gauges(*scene, example);
  example.measured.back().place = {"capture.yaml", 7, 3};
  example.measured.back().direction = {0.0, 0.0, 55.0};
  try {
    check_gauges(*scene, example);
    ADD_FAILURE() << "it was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("capture.yaml:7:3: `strain_of` of example"));
    EXPECT_THAT(error.what(), testing::HasSubstr("the point (0, 0, 55) lies 15 mm outside"));
  }
}

}  // namespace
}  // namespace hookeye::test
