// Sensitivities of equilibria against re-solved ones.
#include <Eigen/Dense>
#include <type_traits>

#include "simulation/bent_block.h"
#include "simulation/sparse_factor.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using test::BentBlock;
using test::plane;

/// How a scene (BentBlock, Slab) depends on one parameter.
template <class Scene>
using Change = std::function<void(Scene&, double)>;

/// dR/dp at fixed q by central differences of the residual, as effects do it.
template <class Scene>
VectorXd dR(const Scene& c, const VectorXd& q, const Change<Scene>& change, double h) {
  Scene up = c, down = c;
  change(up, h);
  change(down, -h);
  return (residual(c.mesh, up.energy(), up.loading(), q) -
          residual(c.mesh, down.energy(), down.loading(), q)) /
         (2 * h);
}

/// S, the force on the base and the moment on the region `levered`, against solving again.
template <class Scene>
void check_sensitivity(const Scene& c, const Region& levered,
                       const std::type_identity_t<Change<Scene>>& change, double h,
                       const VectorXd& dqc, const std::string& what, double relative = 2e-6) {
  const Equilibrium e = c.solved();
  const Loading loading = c.loading();
  const MatrixXd dR_dp = dR(c, e.q, change, h);
  const MatrixXd S = sensitivities(e, loading, dR_dp, dqc);
  const Vector3d about(0.5, -1, 0.3);
  const auto resolved = [&](double t) {
    Scene other = c;
    change(other, t);
    return other.solved();
  };
  test::expect_derivative([&](double t) { return resolved(t).q; }, S, h, relative, what);
  test::expect_derivative([&](double t) { return VectorXd(support_force(resolved(t), c.base)); },
                          d_support_force(e, c.base, dR_dp, S), h, relative, what + ", force");
  test::expect_derivative(
      [&](double t) { return VectorXd(support_moment(resolved(t), levered, about)); },
      d_support_moment(e, levered, about, dR_dp, S), h, relative, what + ", moment");
}

TEST(Sensitivities, LoadsAndSupports) {
  const BentBlock c;
  check_sensitivity(
      c, c.tip, [](BentBlock& x, double h) { x.gravity += h; }, 4e-4, {}, "gravity");
  check_sensitivity(
      c, c.tip, [](BentBlock& x, double h) { x.pressure += h; }, 2e-4, {}, "pressure");
  check_sensitivity(
      c, c.tip, [](BentBlock& x, double h) { x.spring += h; }, 2e-4, {}, "foundation");
  check_sensitivity(
      c, c.tip, [](BentBlock& x, double h) { x.swelling += h; }, 3e-4, {}, "swelling");
  const Loading loading = c.loading();
  VectorXd dqc(static_cast<int>(loading.prescribed.size()));
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    dqc[static_cast<int>(i)] = loading.displacement[static_cast<int>(i)] != 0;
  check_sensitivity(
      c, c.tip, [](BentBlock& x, double h) { x.lift += h; }, 1e-2, dqc, "prescribed motion");
}

/// A slab that is held at one end and bent by a pressure on its upper side, whose rim is free but
/// for the held end: the pressure has no potential and its tangent is unsymmetric.
struct Slab {
  TetMesh mesh = test::block(4, 2, 1, {4, 1.5, 0.6}, 2);
  Region base = plane(mesh, 0, 0), upper = plane(mesh, 2, 0.6);
  double mu = 0.05, kappa = 0.3, pressure = 0.0, widen = 0.0;

  EnergyModel energy() const { return test::of(neo_hookean(mu, kappa)); }
  Loading loading() const {
    Loading l;
    test::hold(mesh, base, l);
    l.displacement = widen * widening(l);
    l.forces = {follower_pressure(upper, pressure)};
    return l;
  }
  /// Change of the held unknowns that stretches the base across.
  VectorXd widening(const Loading& l) const {
    VectorXd dqc = VectorXd::Zero(l.displacement.size());
    for (size_t i = 0; i < l.prescribed.size(); ++i)
      if (l.prescribed[i] % 3 == 1)
        dqc[static_cast<Eigen::Index>(i)] = mesh.X(1, l.prescribed[i] / 3);
    return dqc;
  }
  Equilibrium solved() const { return test::solve(mesh, energy(), loading()); }
  /// Largest motion of a node over the slab's length.
  double motion(const VectorXd& q) const {
    return (q.reshaped(3, mesh.nodes()) - mesh.X).colwise().norm().maxCoeff() / 4.0;
  }
};

class OpenPatch : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Pressures, OpenPatch, testing::Values(2e-5, 2e-4, -2e-4, 4e-4));

TEST_P(OpenPatch, SensitivitiesUnderAPressureWithAFreeRim) {
  Slab c;
  c.pressure = GetParam();
  const Equilibrium e = c.solved();
  EXPECT_GT(e.W_ff.norm(), 0.0);
  EXPECT_GT(c.motion(e.q), std::abs(c.pressure) > 1e-4 ? 0.4 : 0.04);  // bent far, and a little
  const double relative = 1e-5;
  check_sensitivity(
      c, c.base, [](Slab& x, double t) { x.mu += t; }, 1e-4, {}, "mu", relative);
  check_sensitivity(
      c, c.base, [](Slab& x, double t) { x.kappa += t; }, 1e-3, {}, "kappa", relative);
  check_sensitivity(
      c, c.base, [](Slab& x, double t) { x.pressure += t; }, 1e-3 * std::abs(c.pressure), {},
      "pressure", relative);
  check_sensitivity(
      c, c.base, [](Slab& x, double t) { x.widen += t; }, 1e-3, c.widening(c.loading()),
      "motion of the support", relative);
}

TEST_P(OpenPatch, NewtonConvergesAtTheRateOfTheTrueTangent) {
  Slab c;
  c.pressure = GetParam();
  EquilibriumSolver solver(std::make_shared<TetMesh>(c.mesh));
  EquilibriumOptions options;
  options.tolerance = 1e-11;
  ASSERT_TRUE(solver.solve(c.energy(), c.loading(), options).has_value());
  c.pressure *= 1.02;
  const auto warm = solver.solve(c.energy(), c.loading(), options);
  ASSERT_TRUE(warm.has_value());
  EXPECT_GE(warm->newton_iterations, 2);
  EXPECT_LE(warm->newton_iterations, 5);
}

/// What has no skew part pays nothing for it: the factor's solve, to the bit.
TEST(Sensitivities, AHeldRimAndAClosedSurfaceHaveASymmetricTangent) {
  Slab c;
  c.pressure = 2e-4;
  Loading held = c.loading();
  for (int a : c.upper.nodes)
    if (c.mesh.X(0, a) > 4 - 1e-9 || c.mesh.X(1, a) < 1e-9 || c.mesh.X(1, a) > 1.5 - 1e-9) {
      Region node;
      node.nodes = {a};
      test::hold(c.mesh, node, held);
    }
  const BentBlock block;
  const std::pair<Equilibrium, Loading> both[] = {{test::solve(c.mesh, c.energy(), held), held},
                                                  {block.solved(), block.loading()}};
  for (const auto& [e, loading] : both) {
    EXPECT_EQ(e.W_ff.nonZeros(), 0);
    const MatrixXd dR_dp = test::noise(e.q.size(), 3);
    MatrixXd X;
    e.factor->solve(MatrixXd(-dR_dp(e.factor->free(), Eigen::all)), X);
    EXPECT_EQ(sensitivities(e, loading, dR_dp, {})(e.factor->free(), Eigen::all), X);
    EXPECT_GT(X.norm(), 0.0);
  }
}

TEST(Sensitivities, EveryParameterOfEveryLaw) {
  const std::pair<std::shared_ptr<const EnergyTerm>, std::vector<double>> laws[] = {
      {neo_hookean(0.05, 0.6), {0.05, 0.6}},
      {neo_hookean_tied(0.05, 12), {0.05}},
      {stvk(0.3, 0.05), {0.3, 0.05}},
      {mooney_rivlin(0.02, 0.013, 0.6), {0.02, 0.013, 0.6}},
      {yeoh(0.03, -0.002, 0.0007, 0.6), {0.03, -0.002, 0.0007, 0.6}},
      {ogden({0.03, -0.01}, {1.3, -2.7}, 0.6), {0.03, -0.01, 1.3, -2.7, 0.6}}};
  for (const auto& [law, values] : laws) {
    BentBlock c;
    c.mesh = test::block(2, 1, 1, {4, 2, 2}, 2);
    c.base = plane(c.mesh, 0, 0), c.tip = plane(c.mesh, 0, 4), c.side = plane(c.mesh, 2, 2);
    c.law = law;
    c.theta = Eigen::Map<const VectorXd>(values.data(), static_cast<int>(values.size()));
    const Equilibrium e = c.solved();
    for (int k = 0; k < c.theta.size(); ++k) {
      const double h = 0.01 * std::abs(c.theta[k]);
      const auto change = [k](BentBlock& x, double t) { x.theta[k] += t; };
      const VectorXd exact = dR_dtheta(c.mesh, c.energy(), e.q, 0, k);
      const VectorXd S = sensitivities(e, c.loading(), exact, {});
      test::expect_derivative(
          [&](double t) {
            BentBlock other = c;
            change(other, t);
            return other.solved().q;
          },
          S, h, 1e-5, law->name() + " parameter " + std::to_string(k));
    }
  }
}

}  // namespace
}  // namespace hookeye
