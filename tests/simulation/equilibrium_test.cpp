// Equilibria with known answers, and failure.
#include "simulation/equilibrium.h"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "simulation/bent_block.h"

namespace hookeye {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using test::BentBlock;
using test::hold;
using test::of;
using test::plane;
using test::solve;

class Exact : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, Exact, testing::Values(1, 2));

TEST_P(Exact, UniaxialStretchIsExact) {
  // Symmetry planes held, the end pulled by a given stretch: uniform F = diag(l, t, t), P_22 = 0.
  const TetMesh mesh = test::block(3, 2, 2, {3, 1, 1}, GetParam(), 0.25);
  const auto law = neo_hookean(0.05, 0.6);
  const double l = 1.5;
  double t = 1 / std::sqrt(l);
  for (int i = 0; i < 50; ++i) {
    const Matrix3d F = Vector3d(l, t, t).asDiagonal();
    const Matrix9d D = law->dP_dF(F);
    t -= law->P(F)(1, 1) / (D(4, 4) + D(4, 8));
  }
  Loading loading;
  for (int i = 0; i < 3; ++i) loading.prescribe(mesh, plane(mesh, i, 0), i, 0);
  loading.prescribe(mesh, plane(mesh, 0, 3), 0, 3 * (l - 1));
  const Equilibrium e = solve(mesh, of(law), loading);
  const VectorXd exact = (Vector3d(l, t, t).asDiagonal() * mesh.X).reshaped();
  EXPECT_LE((e.q - exact).cwiseAbs().maxCoeff(), 1e-9);
  const double force = law->P(Vector3d(l, t, t).asDiagonal())(0, 0);
  EXPECT_NEAR(support_force(e, plane(mesh, 0, 3)).x(), force, 1e-10);
  EXPECT_NEAR(support_force(e, plane(mesh, 0, 0)).x(), -force, 1e-10);
  const ElementState state = element_state(mesh, of(law), e.q);
  EXPECT_NEAR(state.cauchy_stress(0, 5), force / (t * t), 1e-10);
  EXPECT_NEAR(state.von_mises[5], force / (t * t), 1e-10);
  EXPECT_NEAR(state.J[5], l * t * t, 1e-10);
  EXPECT_NEAR(state.green_strain(0, 5), (l * l - 1) / 2, 1e-10);
  EXPECT_NEAR(state.energy_density.sum() / mesh.size(), internal_energy(mesh, of(law), e.q) / 3,
              1e-10);
}

TEST_P(Exact, PatchTestOfShearAndStretch) {
  const TetMesh mesh = test::block(3, 3, 3, {1, 1, 1}, GetParam(), 0.25);
  Matrix3d F;
  F << 1.2, 0.4, 0, 0, 0.9, -0.1, 0.2, 0, 1.1;
  const VectorXd exact = (F * mesh.X).reshaped();
  const Region skin = test::region_where(mesh, [](const Vector3d& X) {
    return (X.array() < 1e-9).any() || (X.array() > 1 - 1e-9).any();
  });
  Loading loading;
  hold(mesh, skin, loading);
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    loading.displacement[static_cast<int>(i)] =
        exact[loading.prescribed[i]] - mesh.X.reshaped()[loading.prescribed[i]];
  HolzapfelValues fibres;  // twenty times as stiff as the matrix, some slack and some not
  fibres.mu = 0.05, fibres.k1 = 1.0, fibres.k2 = 5.0, fibres.kappa = 0.6;
  fibres.angles = {20, -60, 90};
  for (const auto& law :
       {neo_hookean(0.05, 5.0), mooney_rivlin(0.02, 0.013, 0.6), stvk(0.3, 0.05),
        ogden({0.03, -0.01}, {1.3, -2.7}, 0.6), yeoh(0.03, -0.002, 0.0007, 0.6), holzapfel(fibres)})
    EXPECT_LE((solve(mesh, of(law), loading).q - exact).cwiseAbs().maxCoeff(), 1e-9) << law->name();
}

TEST(Reactions, BalanceAppliedLoads) {
  BentBlock c;
  c.pressure = c.spring = 0;
  const Equilibrium e = c.solved();
  const Vector3d held = support_force(e, c.base) + support_force(e, c.tip);
  EXPECT_LE((held + Vector3d(0.02, c.gravity * 16, 0)).norm(), 1e-9);
  const Vector3d about(1, 2, 3);
  Vector3d applied = Vector3d::Zero();
  const Loading loading = c.loading();
  VectorXd R = VectorXd::Zero(e.q.size());
  for (const auto& f : loading.forces) f->add_residual(c.mesh, e.q, 1.0, R);
  for (int a = 0; a < c.mesh.nodes(); ++a)
    applied -= (e.q.segment<3>(3 * a) - about).cross(Vector3d(R.segment<3>(3 * a)));
  EXPECT_LE((support_moment(e, c.base, about) + support_moment(e, c.tip, about) + applied).norm(),
            1e-9);
}

TEST(Solver, RerunsAreBitEqualAndWarmEqualsCold) {
  const BentBlock c;
  const Equilibrium a = c.solved(), b = c.solved();
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.R, b.R);
  EquilibriumSolver solver(std::make_shared<TetMesh>(c.mesh));
  EquilibriumOptions options;
  options.tolerance = 1e-11;
  const auto first = solver.solve(c.energy(), c.loading(), options);
  ASSERT_TRUE(first.has_value());
  const MatrixXd load = test::noise(a.q.size(), 3);
  const MatrixXd before = sensitivities(*first, c.loading(), load, {});
  BentBlock other = c;
  other.law = neo_hookean(0.0525, 0.57);
  other.lift = 0.7;
  const auto warm = solver.solve(other.energy(), other.loading(), options);
  ASSERT_TRUE(warm.has_value());
  EXPECT_LE((warm->q - other.solved().q).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_EQ(warm->factorizations, 1);
  // The first solution's factor is the caller's: the warm solve must not have written into it.
  EXPECT_EQ(before, sensitivities(*first, c.loading(), load, {}));
}

TEST(Solver, NearlyIncompressibleBendsAndTwists) {
  BentBlock c;
  c.law = neo_hookean(0.05, 5.0);
  c.swelling = 1.0;
  Loading loading;
  hold(c.mesh, c.base, loading);
  RigidMotion motion;
  motion.axis = Vector3d::UnitX();
  motion.degrees = 60;
  motion.center = Vector3d(0, 1, 1);
  motion.move = Vector3d(0.8, 0, 0);
  loading.prescribe_rigid(c.mesh, c.tip, motion);
  const Equilibrium e = solve(c.mesh, c.energy(), loading);
  EXPECT_TRUE(e.stable);
  EXPECT_GT(element_state(c.mesh, c.energy(), e.q).J.minCoeff(), 0.8);
}

/// Mean angle by which the nodes at x = 4 went round the bar's axis [degrees, within half a turn].
double turned_at_the_middle(const TetMesh& mesh, const VectorXd& q) {
  double sine = 0.0, cosine = 0.0;
  for (int a = 0; a < mesh.nodes(); ++a) {
    if (std::abs(mesh.X(0, a) - 4.0) > 1e-9) continue;
    const Vector3d from = mesh.X.col(a) - Vector3d(4, 1, 1), to = q.segment<3>(3 * a);
    sine += from.y() * (to.z() - 1) - from.z() * (to.y() - 1);
    cosine += from.y() * (to.y() - 1) + from.z() * (to.z() - 1);
  }
  return std::atan2(sine, cosine) * 180.0 / std::numbers::pi;
}

TEST(Solver, ATurnGoesRoundByItsAngle) {
  // A bar between two heads, one of which turns (and moves): straight through the axis it would be
  // crushed at half a turn, and be at rest after a whole one.
  const TetMesh mesh = test::block(8, 2, 2, {8, 2, 2}, 2);
  const Region base = plane(mesh, 0, 0), head = plane(mesh, 0, 8);
  double first = 0.0;
  for (const double degrees : {45.0, 180.0, 360.0, -360.0})
    for (const double move : {0.0, 1.0}) {
      Loading loading;
      hold(mesh, base, loading);
      loading.prescribe_rigid(
          mesh, head, {Vector3d::UnitX(), degrees, Vector3d(8, 1, 1), Vector3d(move, 0, 0)});
      const Equilibrium e = solve(mesh, of(neo_hookean(0.05, 0.6)), loading);
      EXPECT_NEAR(std::remainder(turned_at_the_middle(mesh, e.q) - degrees / 2.0, 360.0), 0.0, 0.5)
          << degrees << " " << move;
      // Torsion of a neo-Hookean bar: its moment goes nearly with the angle (exactly, in a circular
      // bar that keeps its volume and its length).
      const double moment = support_moment(e, head, Vector3d(8, 1, 1)).x();
      if (degrees == 45.0 && move == 0.0) first = moment;
      if (move == 0.0) {
        EXPECT_NEAR(moment / first, degrees / 45.0, 0.25 * std::abs(degrees / 45.0));
      }
    }
}

TEST(Solver, QuadraticElementsDoNotLock) {
  // Cook's membrane, kappa/mu = 100: coarse against fine.
  const auto tip_of = [](int n, int order) {
    TetMesh mesh = test::block(n, n, 1, {1, 1, 0.1}, order);
    for (int a = 0; a < mesh.nodes(); ++a) {
      const double x = mesh.X(0, a), y = mesh.X(1, a);
      mesh.X(0, a) = 48 * x;
      mesh.X(1, a) = 44 * x + (44 - 28 * x) * y;
    }
    mesh.X.row(2) *= 10;
    Loading loading;
    const Region left = plane(mesh, 0, 0), right = plane(mesh, 0, 48);
    hold(mesh, left, loading);
    loading.prescribe(mesh,
                      test::region_where(
                          mesh, [](const Vector3d& X) { return X.z() < 1e-9 || X.z() > 1 - 1e-9; }),
                      2, 0);
    loading.forces = {dead_force(right, Vector3d(0, 0.02 * 16, 0))};
    const Equilibrium e = solve(mesh, of(neo_hookean(0.3, 30.0)), loading, 1e-9);
    double v = 0;
    for (int a : right.nodes) v = std::max(v, e.q[3 * a + 1] - mesh.X(1, a));
    return v;
  };
  const double fine = tip_of(24, 2), coarse = tip_of(12, 2), linear = tip_of(24, 1);
  EXPECT_NEAR(coarse, fine, 0.02 * fine);
  EXPECT_LT(linear, 0.9 * fine) << "the test does not see locking: linear elements should lock";
}

TEST(Solver, FailureSaysWhereAndWhy) {
  BentBlock c;
  Loading loading;
  loading.name = "crush";
  hold(c.mesh, c.base, loading);
  hold(c.mesh, c.tip, loading);
  loading.prescribe(c.mesh, c.tip, 0, -4.5);  // through the base
  EquilibriumOptions options;
  options.max_iterations = 30;
  options.smallest_step = 1e-2;
  auto result = solve_equilibrium(c.mesh, c.energy(), loading, options);
  ASSERT_FALSE(result);
  const auto& failure = result.error();
  EXPECT_EQ(failure.example, "crush");
  EXPECT_GT(failure.load_fraction, 0.1);
  EXPECT_LT(failure.load_fraction, 0.9);
  EXPECT_THAT(failure.reason, testing::HasSubstr("element"));

  Loading floating;
  floating.forces = {dead_force(c.tip, Vector3d(1, 0, 0))};
  result = solve_equilibrium(c.mesh, c.energy(), floating);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().reason, testing::HasSubstr("translation along (1, 0, 0)"));

  options.cancelled = [] { return true; };
  result = solve_equilibrium(c.mesh, c.energy(), c.loading(), options);
  ASSERT_FALSE(result);
  EXPECT_TRUE(cancelled(result.error()));
}

TEST(Solver, ALimitOnItsIterationsEndsTheSearchForWhatIsNotThere) {
  BentBlock c;
  EquilibriumSolver solver(std::make_shared<TetMesh>(c.mesh));
  EquilibriumOptions options;
  int asked = 0;  // once an iteration, and once where one ends
  options.cancelled = [&asked] { return ++asked, false; };
  ASSERT_TRUE(solver.solve(c.energy(), c.loading(), options).has_value());
  Loading loading;
  hold(c.mesh, c.base, loading);
  hold(c.mesh, c.tip, loading);
  loading.prescribe(c.mesh, c.tip, 0, -4.5);  // through the base
  asked = 0;
  solver.solve(c.energy(), loading, options);
  EXPECT_GT(asked, 60) << "too easy a case: no limit would be needed";
  asked = 0;
  options.most_iterations = 20;  // of either way, from where the body was and from rest
  const auto result = solver.solve(c.energy(), loading, options);
  ASSERT_FALSE(result);
  EXPECT_LE(asked, 50);
  // What it had found before still starts the next one.
  EXPECT_TRUE(solver.solve(c.energy(), c.loading(), options).has_value());
}

TEST(Solver, WithoutItsFactorTheEquilibriumIsTheSame) {
  BentBlock c;
  EquilibriumOptions options;
  const auto with = solve_equilibrium(c.mesh, c.energy(), c.loading(), options);
  options.factored = false;
  const auto without = solve_equilibrium(c.mesh, c.energy(), c.loading(), options);
  const Equilibrium &a = *with, &b = *without;
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.factorizations, b.factorizations + 1);
  EXPECT_TRUE(a.factor);
  EXPECT_FALSE(b.factor);
}

/// A warm start begins where the solution is expected, and where that is nonsense at the last one.
TEST(Solver, StartsWhereTheSolutionIsExpected) {
  BentBlock c;
  const auto iterations = [&](const VectorXd* expected, VectorXd& q) {
    BentBlock now = c;
    EquilibriumSolver solver(std::make_shared<const TetMesh>(now.mesh));
    EquilibriumOptions options;
    if (!solver.solve(now.energy(), now.loading(), options).has_value()) return -1;
    now.gravity *= 1.3, now.lift *= 1.1;
    options.expected = expected;
    const auto result = solver.solve(now.energy(), now.loading(), options);
    if (!result.has_value()) return -1;
    q = result->q;
    return result->newton_iterations;
  };
  VectorXd q, expected, odd;
  const int without = iterations(nullptr, q);
  ASSERT_GT(without, 1);
  EXPECT_LE(iterations(&q, expected), 1);
  EXPECT_LE((expected - q).cwiseAbs().maxCoeff(), 1e-7);
  const VectorXd turned_inside_out = -q;
  EXPECT_EQ(iterations(&turned_inside_out, odd), without);
  EXPECT_EQ(odd, q);
}

/// A wall that is suddenly inside the loaded body and far harder than it is met from where the body
/// was: what it leaves out of balance fades step by step. No such steps lead there from rest.
TEST(Solver, MeetsAHardWallThatStandsInsideTheBody) {
  BentBlock c;
  Loading loading = c.loading();
  loading.prescribed.clear(), loading.displacement.resize(0);
  hold(c.mesh, c.base, loading);
  EquilibriumSolver solver(std::make_shared<const TetMesh>(c.mesh));
  const auto free = solver.solve(c.energy(), loading, {});
  ASSERT_TRUE(free.has_value());
  const double wall = 1.9;  // a twentieth of the height is beyond it
  ASSERT_GT(free->q.reshaped(3, c.mesh.nodes()).row(2).maxCoeff(), 2.0);
  loading.forces.push_back(
      floor_contact(c.mesh, Vector3d(0, 0, wall), Vector3d(0, 0, -1), 1000.0, 1e-3));
  const auto met = solver.solve(c.energy(), loading, {});
  ASSERT_TRUE(met.has_value()) << met.error().reason;
  const VectorXd& q = met->q;
  const VectorXd R = residual(c.mesh, c.energy(), loading, q);
  for (int u = 0; u < R.size(); ++u) {
    if (std::binary_search(loading.prescribed.begin(), loading.prescribed.end(), u)) continue;
    EXPECT_NEAR(R[u], 0.0, 1e-7);
  }
}

/// A small load needs one factorization: the predictor's serves Newton too.
TEST(Solver, KeepsThePredictorsFactorWhereItCameNear) {
  BentBlock c;
  c.lift = 0.01, c.gravity = 1e-4, c.pressure = 1e-4, c.swelling = 1.0;
  EquilibriumOptions options;
  options.factored = false;
  const auto found = solve_equilibrium(c.mesh, c.energy(), c.loading(), options);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->factorizations, 1);
  EXPECT_LE((found->q - c.solved().q).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Solver, UnloadedBodyStaysAtRest) {
  BentBlock c;
  c.swelling = 1;
  Loading loading;
  hold(c.mesh, c.base, loading);
  const Equilibrium e = solve(c.mesh, of(c.law), loading, 1e-9);
  EXPECT_LE((e.q - VectorXd(c.mesh.X.reshaped())).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(e.stable);
}

TEST(Solver, FreeBodySwellsInPlace) {
  const BentBlock c;  // swollen, and nothing holds it: self-equilibrated
  const Equilibrium e = solve(c.mesh, c.energy(), Loading{}, 1e-9);
  EXPECT_LE(
      (element_state(c.mesh, c.energy(), e.q).J.array() - std::pow(c.swelling, 3)).abs().maxCoeff(),
      1e-8);
  EXPECT_TRUE(e.stable);
}

TEST(Solver, FoundationAloneHoldsTheBody) {
  BentBlock c;
  Loading loading;
  loading.forces = {elastic_foundation(c.base, 0.5, 0.5, c.mesh.X.reshaped()),
                    dead_force(c.tip, Vector3d(0.05, 0, 0))};
  const Equilibrium e = solve(c.mesh, of(c.law), loading, 1e-9);
  EXPECT_TRUE(e.stable);
  double mean = 0;
  for (int a : c.base.nodes)
    mean += c.base.nodal_area[a] / c.base.area * (e.q[3 * a] - c.mesh.X(0, a));
  EXPECT_NEAR(mean, 0.05 / (0.5 * 4), 1e-7);
}

TEST(Solver, SlenderColumnLeavesTheUnstableBranch) {
  const TetMesh mesh = test::block(10, 1, 1, {20, 1, 1}, 2);
  Loading loading;
  hold(mesh, plane(mesh, 0, 0), loading);
  hold(mesh, plane(mesh, 0, 20), loading);
  loading.prescribe(mesh, plane(mesh, 0, 20), 0, -2.0);  // ten times the buckling strain
  const Equilibrium e = solve(mesh, of(neo_hookean(0.05, 0.6)), loading, 1e-9);
  EXPECT_TRUE(e.stable);
  double bow = 0;
  for (int a = 0; a < mesh.nodes(); ++a)
    bow = std::max(bow, (e.q.segment<3>(3 * a) - mesh.X.col(a)).tail<2>().norm());
  EXPECT_GT(bow, 1.0) << "the straight column bulges by less than 0.1";
}

}  // namespace
}  // namespace hookeye
