// Sensitivities of equilibria against re-solved ones.
#include <Eigen/Dense>

#include "simulation/bent_block.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using test::BentBlock;
using test::plane;

/// dR/dp at fixed q by central differences of the residual, as effects do it.
VectorXd dR(const BentBlock& c, const VectorXd& q,
            const std::function<void(BentBlock&, double)>& change, double h) {
  BentBlock up = c, down = c;
  change(up, h);
  change(down, -h);
  return (residual(c.mesh, up.energy(), up.loading(), q) -
          residual(c.mesh, down.energy(), down.loading(), q)) /
         (2 * h);
}

void check_sensitivity(const BentBlock& c, const std::function<void(BentBlock&, double)>& change,
                       double h, const VectorXd& dqc, const std::string& what,
                       double relative = 2e-6) {
  const Equilibrium e = c.solved();
  const Loading loading = c.loading();
  const MatrixXd dR_dp = dR(c, e.q, change, h);
  const MatrixXd S = sensitivities(e, loading, dR_dp, dqc);
  const Vector3d about(0.5, -1, 0.3);
  const auto resolved = [&](double t) {
    BentBlock other = c;
    change(other, t);
    return other.solved();
  };
  test::expect_derivative([&](double t) { return resolved(t).q; }, S, h, relative, what);
  test::expect_derivative([&](double t) { return VectorXd(support_force(resolved(t), c.base)); },
                          d_support_force(e, c.base, dR_dp, S), h, relative, what + ", force");
  test::expect_derivative(
      [&](double t) { return VectorXd(support_moment(resolved(t), c.tip, about)); },
      d_support_moment(e, c.tip, about, dR_dp, S), h, relative, what + ", moment");
}

TEST(Sensitivities, LoadsAndSupports) {
  const BentBlock c;
  check_sensitivity(
      c, [](BentBlock& x, double h) { x.gravity += h; }, 4e-4, {}, "gravity");
  check_sensitivity(
      c, [](BentBlock& x, double h) { x.pressure += h; }, 2e-4, {}, "pressure");
  check_sensitivity(
      c, [](BentBlock& x, double h) { x.spring += h; }, 2e-4, {}, "foundation");
  check_sensitivity(
      c, [](BentBlock& x, double h) { x.swelling += h; }, 3e-4, {}, "swelling");
  const Loading loading = c.loading();
  VectorXd dqc(static_cast<int>(loading.prescribed.size()));
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    dqc[static_cast<int>(i)] = loading.displacement[static_cast<int>(i)] != 0;
  check_sensitivity(
      c, [](BentBlock& x, double h) { x.lift += h; }, 1e-2, dqc, "prescribed motion");
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
