// The additive law: against textbook laws, automatic differentiation and finite differences.
#include "simulation/additive.h"

#include <ceres/jet.h>
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>

#include "simulation/additive_anew.h"
#include "simulation/blocks.h"
#include "simulation/ellipticity.h"
#include "simulation/energy_model.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using Law = std::shared_ptr<const EnergyTerm>;

Matrix3d some_frame() { return Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).matrix(); }

/// One addend of every kind, control points on both sides, a wall, a barrier.
AdditiveModel every_kind() {
  AdditiveModel model;
  model.frame = some_frame();
  add_addend(model, "E11", {-0.2, 0.05, 0.3}, {}, Vector3d(0.8, 1.0, 3.0));
  add_addend(model, "E22", {-0.1, 0.4}, {}, Eigen::Vector2d(1.2, 2.5));
  add_addend(model, "E12", {0.0, 0.1, 0.3}, {}, Vector3d(0.7, 0.9, 2.0));
  add_addend(model, "E13", {-0.1, 0.1}, {}, Eigen::Vector2d(0.3, 0.6));
  add_addend(model, "E23", {0.05}, {}, VectorXd::Constant(1, 0.4));
  add_addend(model, "E33", {0.0}, {}, VectorXd::Constant(1, 0.9));
  VectorXd grid(6);
  grid << 0.1, 0.2, 0.15, 0.3, 0.1, 0.25;
  add_addend(model, "E11_E22", {-0.1, 0.2}, {-0.2, 0.02, 0.3}, grid);
  add_addend(model, "E22_E33", {0.0}, {0.0}, VectorXd::Constant(1, 0.2));
  add_addend(model, "trE", {-0.3, 0.2, 0.5}, {}, Vector3d(0.2, 0.5, 0.7));
  add_addend(model, "I1bar", {0.0, 0.3, 0.8}, {}, Vector3d(0.5, 0.2, 0.6));
  add_addend(model, "J", {-0.3, 0.1}, {}, Eigen::Vector2d(5.0, 3.0));
  add_addend(model, "fibre1", {-0.2, 0.0, 0.3}, {}, Vector3d(0.0, 0.5, 2.0));
  model.components[component_index(model, "fibre1")].direction = Vector3d(1, 1, 0.5).normalized();
  add_addend(model, "E11", {0.35, 0.4}, {}, Eigen::Vector2d(0.0, 20.0));
  model.addends.back().name = "E11.wall";
  model.addends.back().fixed = true;
  model.barrier_modulus = 0.7;
  model.barrier_below = 0.6;
  return model;
}

std::vector<std::pair<std::string, Matrix3d>> deformations() {
  std::vector<std::pair<std::string, Matrix3d>> all;
  const Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).matrix();
  for (unsigned seed = 1; seed <= 6; ++seed)
    all.emplace_back("random " + std::to_string(seed),
                     turn * (Matrix3d::Identity() + 0.25 * test::noise(9, seed).reshaped(3, 3)));
  all.emplace_back("small", Matrix3d::Identity() + 1e-3 * test::noise(9, 11).reshaped(3, 3));
  all.emplace_back("strong compression", turn * Vector3d(0.45, 0.9, 0.8).asDiagonal());
  return all;
}

TEST(Additive, AgreesWithAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 9>;
  const AdditiveModel model = every_kind();
  ASSERT_FALSE(fault(model)) << fault(model)->wrong;
  const Law law = additive(model);
  for (const auto& [what, F] : deformations()) {
    Eigen::Matrix<Jet, 3, 3> x;
    for (int k = 0; k < 9; ++k) x(k % 3, k / 3) = Jet(F(k % 3, k / 3), k);
    const Jet y = test::energy_anew<Jet>(model, x);
    const double scale = law->dP_dF(F).norm();
    EXPECT_NEAR(law->psi(F), y.a, 1e-13 * scale) << what;
    EXPECT_LE((law->P(F).reshaped() - y.v).norm(), 1e-12 * scale) << what;
  }
}

TEST(Additive, StressAndStiffnessAreDerivatives) {
  const Law law = additive(every_kind());
  for (const auto& [what, F] : deformations()) {
    const Matrix9d D = law->dP_dF(F);
    EXPECT_LE((D - D.transpose()).norm(), 1e-13 * D.norm()) << what;
    for (int k = 0; k < 9; ++k) {
      Matrix3d direction = Matrix3d::Zero();
      direction(k % 3, k / 3) = 1;
      const auto P = [&, &F = F](double h) {
        return VectorXd(law->P(F + h * direction).reshaped());
      };
      // The third derivative of a cubic spline jumps at control points: second order, so h is
      // small.
      test::expect_derivative(P, D.col(k), 1e-6, 1e-5, what);
      const auto psi = [&, &F = F](double h) {
        return VectorXd::Constant(1, law->psi(F + h * direction));
      };
      test::expect_derivative(psi, VectorXd::Constant(1, law->P(F)(k % 3, k / 3)), 1e-5, 1e-5,
                              what);
    }
  }
}

/// Over an edge of a coupling's cells the stiffness may jump and the stress must not: on both sides
/// of every control point, along both axes, and at the corners.
TEST(Additive, StressIsContinuousOverTheEdgesOfCells) {
  const AdditiveModel model = every_kind();
  const Addend& grid = *model.find("E11_E22");
  const auto law = additive(model);
  const auto stress = [&](double e11, double e22) {
    const Vector3d stretch(std::sqrt(1 + 2 * e11), std::sqrt(1 + 2 * e22), 1.02);
    Matrix3d shear = Matrix3d::Identity();
    shear(0, 2) = 0.05;  // keeps E11 and E22
    const Matrix3d F = shear * Matrix3d(stretch.asDiagonal());
    return law->P(F * model.frame.transpose());
  };
  const auto jump = [&](double e11, double e22, double d11, double d22) {
    return (stress(e11 + d11, e22 + d22) - stress(e11 - d11, e22 - d22)).norm();
  };
  const double h = 1e-6, size = stress(0.1, 0.1).norm();
  for (double e11 : grid.at)
    for (double e22 : {-0.15, 0.15}) EXPECT_LT(jump(e11, e22, h, 0), 50 * h * size) << e11;
  for (double e22 : grid.at_second)
    for (double e11 : {-0.05, 0.1}) EXPECT_LT(jump(e11, e22, 0, h), 50 * h * size) << e22;
  for (double e11 : grid.at)
    for (double e22 : grid.at_second)
      for (double side : {-1.0, 1.0}) EXPECT_LT(jump(e11, e22, h, side * h), 50 * h * size);
}

TEST(Additive, ForcesAreLinearInTheControlValues) {
  const AdditiveModel model = every_kind();
  const Law law = additive(model);
  const VectorXd p = model.values();
  ASSERT_EQ(static_cast<int>(law->parameters(Units{"mm", "N"}).size()), law->size());
  for (const auto& [what, F] : deformations()) {
    const auto all = law->all_dP_dtheta(F);
    for (int k = 0; k < p.size(); ++k) {
      VectorXd v = p;
      v[k] += 1.0;
      const VectorXd change = (law->with(v)->P(F) - law->P(F)).reshaped();
      EXPECT_LE((change - all.col(k)).norm(), 1e-12 * law->P(F).norm()) << what << ", " << k;
      EXPECT_EQ(law->dP_dtheta(F, k).reshaped(), all.col(k));
    }
    // Without wall and barrier the stress is nothing but the sum.
    AdditiveModel plain = model;
    plain.addends.pop_back();
    plain.barrier_modulus = 0;
    const Law sum = additive(plain);
    EXPECT_LE((all * p - VectorXd(sum->P(F).reshaped())).norm(), 1e-12 * sum->P(F).norm()) << what;
  }
}

TEST(Additive, NineAddendsAreStVkToRounding) {
  const Law a = additive(additive_stvk(0.3, 0.05)), b = stvk(0.3, 0.05);
  EXPECT_EQ(a->size(), 9);
  for (const auto& [what, F] : deformations()) {
    const double scale = b->dP_dF(F).norm();
    EXPECT_NEAR(a->psi(F), b->psi(F), 1e-15 * scale) << what;
    EXPECT_LE((a->P(F) - b->P(F)).norm(), 1e-15 * scale) << what;
    EXPECT_LE((a->dP_dF(F) - b->dP_dF(F)).norm(), 1e-15 * scale) << what;
  }
}

TEST(Additive, PlaneStVkIsFourAddends) {
  // Eq. 3 of the paper: W = (lambda/2 + mu)(E11^2 + E22^2) + lambda E11 E22 + 2 mu E12^2.
  const double lambda = 0.3, mu = 0.05;
  AdditiveModel plane;
  const auto one = [](double v) { return VectorXd::Constant(1, v); };
  add_addend(plane, "E11", {0.0}, {}, one(lambda + 2 * mu));
  add_addend(plane, "E22", {0.0}, {}, one(lambda + 2 * mu));
  add_addend(plane, "E11_E22", {0.0}, {0.0}, one(lambda));
  add_addend(plane, "E12", {0.0}, {}, one(4 * mu));
  const Law law = additive(plane);
  for (const auto& [what, F] : deformations()) {
    const Matrix3d E = 0.5 * (F.transpose() * F - Matrix3d::Identity());
    const double expected = (lambda / 2 + mu) * (E(0, 0) * E(0, 0) + E(1, 1) * E(1, 1)) +
                            lambda * E(0, 0) * E(1, 1) + 2 * mu * E(0, 1) * E(0, 1);
    EXPECT_NEAR(law->psi(F), expected, 1e-16) << what;
  }
}

TEST(Additive, ConstantInvariantAddendsAreNeoHooke) {
  const Law a = additive(additive_neo_hookean(0.05, 0.6)), b = neo_hookean(0.05, 0.6);
  for (const auto& [what, F] : deformations()) {
    const double scale = b->dP_dF(F).norm();
    EXPECT_NEAR(a->psi(F), b->psi(F), 1e-15 * scale) << what;
    EXPECT_LE((a->P(F) - b->P(F)).norm(), 2e-14 * scale) << what;
    EXPECT_LE((a->dP_dF(F) - b->dP_dF(F)).norm(), 2e-14 * scale) << what;
  }
  const Matrix3d I = Matrix3d::Identity();
  EXPECT_LE((a->dP_dF(I) - b->dP_dF(I)).norm(), 1e-15);
  for (const Law& law : {a, b}) {
    const auto model = as_additive(*law);
    ASSERT_TRUE(model);
    EXPECT_LE((model->values() - Eigen::Vector2d(0.05, 0.6)).norm(), 1e-15);
  }
  EXPECT_FALSE(as_additive(*yeoh(0.03, 0, 0.001, 0.6)));
}

TEST(Additive, UniaxialBiaxialShearAndVolumetricCurves) {
  // Control values are tangent moduli of these very curves.
  AdditiveModel model;
  add_addend(model, "E11", {0.0, 0.5}, {}, Eigen::Vector2d(1.0, 5.0));
  add_addend(model, "E12", {0.0, 0.2}, {}, Eigen::Vector2d(0.4, 0.8));
  add_addend(model, "I1bar", {0.0, 1.0}, {}, Eigen::Vector2d(0.3, 0.9));
  add_addend(model, "J", {-0.5, 0.0, 0.5}, {}, Vector3d(4.0, 2.0, 1.0));
  const auto only = [&](const char* name) {
    AdditiveModel one = model;
    one.addends = {*model.find(name)};
    return additive(one);
  };
  for (double l : {1.1, 1.3, 1.5}) {  // E11 = (l^2-1)/2, P11 = l S11, S11 = e + 4 e^2
    const double e = 0.5 * (l * l - 1);
    const double S = e <= 0.5 ? e + 4 * e * e : 1.5 + 5 * (e - 0.5);
    EXPECT_NEAR(only("E11")->P(Vector3d(l, 1, 1).asDiagonal())(0, 0), l * S, 1e-14);
    EXPECT_NEAR(only("E11")->P(Vector3d(l, l, 1).asDiagonal())(1, 1), 0.0, 1e-15);
  }
  for (double g : {0.1, 0.35, -0.35}) {  // simple shear: E12 = g/2; sqrt(I1bar - 3) = |g|
    Matrix3d F = Matrix3d::Identity();
    F(0, 1) = g;
    const double e = std::abs(g) / 2, sign = g < 0 ? -1 : 1;
    EXPECT_NEAR(only("E12")->P(F)(0, 1), sign * 0.5 * (0.4 * e + e * e), 1e-15);
    EXPECT_NEAR(only("I1bar")->P(F)(0, 1), sign * (0.3 * std::abs(g) + 0.3 * g * g), 1e-14);
  }
  for (double J : {0.7, 1.2, 1.8}) {  // pressure dPsi/dJ
    const double e = J - 1;
    const double p = e < 0 ? 2 * e - 2 * e * e : e <= 0.5 ? 2 * e - e * e : 0.75 + (e - 0.5);
    const double l = std::cbrt(J);
    EXPECT_NEAR(only("J")->P(l * Matrix3d::Identity())(0, 0), p * l * l, 1e-14);
  }
}

/// Energy, slope and curvature of an addend along its strain, on both sides of rest.
TEST(Additive, CurvesHaveTheirDerivatives) {
  const AdditiveModel model = every_kind();
  int even = 0;
  for (size_t i = 0; i < model.addends.size(); ++i) {
    const Addend& a = model.addends[i];
    if (a.second >= 0) continue;
    even += a.even;
    const auto at = [&](double e) { return addend_curve(model, static_cast<int>(i), e); };
    for (double e : {-0.37, -0.16, 0.17, 0.38}) {
      if (at(e).isZero(0.0)) continue;  // short of a wall
      const std::string label = a.name + " at " + std::to_string(e);
      test::expect_derivative([&](double h) { return VectorXd(at(e + h).head<2>()); },
                              at(e).tail<2>(), 1e-3, 1e-9, label);
    }
  }
  EXPECT_EQ(even, 3);
}

TEST(Additive, RefinementLeavesTheFunctionAlone) {
  const AdditiveModel model = every_kind();
  AdditiveModel fine = model;
  const int n = static_cast<int>(model.addends.size()) - 1;  // all but the wall
  for (int a = 0; a < n; ++a)
    for (double x : {-0.3, -0.05, 0.0, 0.12, 0.2, 0.6}) {
      if (model.addends[a].even && x < 0) continue;
      fine = refined(fine, a, x);
      if (fine.addends[a].second >= 0) fine = refined(fine, a, x + 0.01, true);
    }
  ASSERT_GT(fine.size(), 2 * model.size());
  EXPECT_EQ(refined(fine, 0, 0.12).size(), fine.size());
  AdditiveModel full = model;
  for (int i = 0; i < 100; ++i) full = refined(full, 0, 0.4 + 1e-3 * i);
  EXPECT_EQ(full.addends[0].at.size(), static_cast<size_t>(kMostControlPoints));
  const Law a = additive(model), b = additive(fine);
  for (const auto& [what, F] : deformations()) {
    const double scale = a->dP_dF(F).norm();
    EXPECT_NEAR(a->psi(F), b->psi(F), 1e-14 * scale) << what;
    EXPECT_LE((a->P(F) - b->P(F)).norm(), 1e-13 * scale) << what;
    EXPECT_LE((a->dP_dF(F) - b->dP_dF(F)).norm(), 1e-13 * scale) << what;
  }
}

TEST(Additive, FramesOfElementsTurnTheMaterial) {
  // A frame in the law, the same frame on the part, and a body turned the other way agree.
  AdditiveModel model = every_kind();
  model.components[component_index(model, "fibre1")].direction = model.frame.col(0);
  const Law own = additive(model);
  AdditiveModel straight = model;
  straight.frame = Matrix3d::Identity();
  straight.components[component_index(straight, "fibre1")].direction = Vector3d::UnitX();
  EnergyModel::Part part{additive(straight), {}, {}};
  part.frames = model.frame.reshaped(9, 1);
  for (const auto& [what, F] : deformations()) {
    EXPECT_NEAR(own->psi(F), part.psi(0, F), 1e-13) << what;
    EXPECT_LE((own->P(F) - part.P(0, F)).norm(), 1e-12) << what;
    EXPECT_LE((own->dP_dF(F) - part.dP_dF(0, F)).norm(), 1e-11) << what;
    EXPECT_LE((own->all_dP_dtheta(F) - part.all_dP_dtheta(0, F)).norm(), 1e-12) << what;
    EXPECT_LE((own->dP_dtheta(F, 3) - part.dP_dtheta(0, F, 3)).norm(), 1e-13) << what;
  }
  const CylinderFrame tube{Vector3d::UnitZ(), Vector3d(1, 0, 0)};
  const Eigen::MatrixXd frames = cylinder_frames(tube, Vector3d(1, 2, 5));
  EXPECT_LE((frames.reshaped(3, 3).col(0) - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LE((frames.reshaped(3, 3).col(1) + Vector3d::UnitX()).norm(), 1e-15);
}

TEST(Additive, CountsStrainsBeyondTheControlPoints) {
  const AdditiveModel model = every_kind();
  VectorXd e = VectorXd::Zero(static_cast<Eigen::Index>(model.components.size()));
  for (bool beyond : beyond_control_points(model, e)) EXPECT_FALSE(beyond);
  e[model.find("E11")->first] = 0.31;
  e[model.find("E12")->first] = -0.31;
  const auto beyond = beyond_control_points(model, e);
  EXPECT_TRUE(beyond[0]);       // E11
  EXPECT_TRUE(beyond[2]);       // E12, mirrored
  EXPECT_TRUE(beyond[6]);       // E11_E22
  EXPECT_FALSE(beyond[5]);      // E33: a constant
  EXPECT_FALSE(beyond.back());  // the wall
}

TEST(Ellipticity, NoPairOfDirectionsLiesBelow) {
  const Law law = additive(every_kind());
  for (const auto& [what, F] : deformations()) {
    const Matrix9d D = law->dP_dF(F);
    const Ellipticity found = ellipticity(D);
    double least = std::numeric_limits<double>::infinity();
    for (unsigned seed = 1; seed <= 3000; ++seed) {
      const VectorXd r = test::noise(6, seed);
      const VectorXd mn =
          (r.head<3>().normalized() * r.tail<3>().normalized().transpose()).reshaped();
      least = std::min(least, mn.dot(D * mn));
    }
    EXPECT_LE(found.smallest, least + 1e-12) << what;
    EXPECT_GE(found.smallest, least - 0.1 * D.norm()) << what;
    const VectorXd own = (found.m * found.n.transpose()).reshaped();
    EXPECT_NEAR(own.dot(D * own), found.smallest, 1e-9 * D.norm()) << what;
  }
}

}  // namespace
}  // namespace hookeye
