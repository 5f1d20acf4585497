// Where materials end: energy limits that Newton climbs, and laws that lose ellipticity.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "simulation/additive.h"
#include "simulation/blocks.h"
#include "simulation/ellipticity.h"
#include "simulation/equilibrium.h"

namespace hookeye {
namespace {

/// A bar along x, clamped at one end, whose E11 cannot go far beyond 0.3: neo-Hooke with a wall a
/// thousand times as stiff.
struct Bar {
  static constexpr double kMu = 0.05, kBegin = 0.3, kWidth = 0.05;
  TetMesh mesh = test::block(6, 2, 2, {6, 2, 2}, 2, 0.2);
  Region base = end(0), tip = end(6);

  Region end(double x) const {
    return test::region_where(mesh, [=](const Vector3d& X) { return std::abs(X[0] - x) < 1e-9; });
  }
  static AdditiveModel model(double wall) {
    AdditiveModel out = additive_neo_hookean(kMu, 0.5);
    add_addend(out, "E11", {kBegin, kBegin + kWidth}, {}, Eigen::Vector2d(0.0, wall));
    out.addends.back().name = "E11.wall";
    out.addends.back().fixed = true;
    return out;
  }
  Equilibrium under(const Vector3d& force, double wall) const {
    Loading loading;
    for (int i = 0; i < 3; ++i) loading.prescribe(mesh, base, i, 0);
    loading.forces = {dead_force(tip, force)};
    EnergyModel energy;
    energy.parts.push_back({additive(model(wall)), {}, {}});
    auto solved = solve_equilibrium(mesh, energy, loading);
    if (!solved) {
      ADD_FAILURE() << solved.error().reason << " at " << solved.error().load_fraction;
      return {};
    }
    return *std::move(solved);
  }
  /// E11 over the elements in the middle half, away from the ends.
  VectorXd middle_strain(const Equilibrium& e, double wall) const {
    EnergyModel energy;
    energy.parts.push_back({additive(model(wall)), {}, {}});
    const ElementState state = element_state(mesh, energy, e.q);
    std::vector<double> out;
    for (Eigen::Index k = 0; k < mesh.size(); ++k) {
      double x = 0.0;
      for (int c = 0; c < 4; ++c) x += mesh.X(0, mesh.elements(c, k)) / 4.0;
      if (x > 1.5 && x < 4.5) out.push_back(state.green_strain(0, k));
    }
    return Eigen::Map<VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
  }
};

TEST(Wall, NewtonClimbsIt) {
  const Bar bar;
  const double wall = 1000.0 * Bar::kMu;
  // Ten times the force that takes the bar to where the wall begins (3 mu e on 4 mm^2, e = 0.26).
  const Vector3d force(10.0 * 4.0 * 3.0 * Bar::kMu * 0.26, 0.0, 0.0);
  const Equilibrium e = bar.under(force, wall);
  ASSERT_GT(e.q.size(), 0);
  EXPECT_TRUE(e.stable);
  EXPECT_LE(e.newton_iterations, 60);
  const VectorXd E11 = bar.middle_strain(e, wall);
  EXPECT_GT(E11.minCoeff(), Bar::kBegin - 0.02);
  EXPECT_LT(E11.maxCoeff(), Bar::kBegin + 2.0 * Bar::kWidth);
  EXPECT_NEAR(support_force(e, bar.base).x(), -force.x(), 1e-6 * force.x());
}

TEST(Wall, ChangesNothingBelowItsBeginning) {
  const Bar bar;
  // Pressed, at half of what makes it buckle: E11 is nowhere near the wall.
  const Vector3d press(-0.006, 0.0, 0.0);
  EXPECT_EQ(bar.under(press, 0.0).q, bar.under(press, 1000.0 * Bar::kMu).q);
}

TEST(Wall, TwiceTheForceGoesHardlyFurther) {
  const Bar bar;
  const double wall = 1000.0 * Bar::kMu;
  const auto mean = [&](double force) {
    return bar.middle_strain(bar.under({force, 0, 0}, wall), wall).mean();
  };
  const double one = mean(1.5), two = mean(3.0);
  EXPECT_GT(two, one);
  EXPECT_LT(two - one, 0.03);
}

TEST(Ellipticity, StVkLosesItAtUniaxialStretchOfOneOverRootThree) {
  const auto at = [](double lambda, double l) {
    return ellipticity(stvk(lambda, 0.05)->dP_dF(Vector3d(l, 1, 1).asDiagonal())).smallest;
  };
  // P11 = (lambda/2 + mu)(l^3 - l) has its minimum at l = 1/sqrt(3) = 0.57735, where the wave along
  // the stretch stands still; oblique waves do so a little before.
  const double critical = 1 / std::sqrt(3.0);
  for (double lambda : {0.0, 0.1, 0.3})
    EXPECT_NEAR(stvk(lambda, 0.05)->dP_dF(Vector3d(critical, 1, 1).asDiagonal())(0, 0), 0.0, 1e-16);
  EXPECT_LT(at(0, critical), 0.0);
  EXPECT_GT(at(0, critical + 0.03), 0.0);
  EXPECT_NEAR(at(0, 0.5), 0.05 * (3 * 0.25 - 1), 1e-9);
  // With lambda the pressure across the stretch is first: m along, n across it,
  // S22 + mu l^2 = lambda (l^2 - 1)/2 + mu l^2 = 0 at l^2 = 0.75 for lambda = 6 mu.
  EXPECT_GT(at(0.3, std::sqrt(0.75) + 0.02), 0.0);
  EXPECT_LT(at(0.3, std::sqrt(0.75) - 1e-4), 0.0);
  EXPECT_LT(at(0.3, critical), 0.0);
  // At rest: mu, the slower of the two waves.
  EXPECT_NEAR(at(0.3, 1.0), 0.05, 1e-12);
}

}  // namespace
}  // namespace hookeye
