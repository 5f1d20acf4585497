// One Newton iteration (energy, inversion test, forces, tangent, factor, solve) with the additive
// law of 100 control points against neo-Hooke on the same block, CPU seconds of one thread.
// bench_simulation --benchmark_filter=newton_iteration: the second figure over the first, at
// most 1.3.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>

#include "simulation/additive.h"
#include "simulation/assembly.h"
#include "simulation/blocks.h"
#include "simulation/sparse_factor.h"

namespace hookeye {
namespace {

/// Every component of E with 15 points, a coupling of 3 x 2, I1bar and J with two: 100 values.
AdditiveModel hundred() {
  AdditiveModel model = additive_neo_hookean(0.05, 0.5);
  model = refined(refined(model, 0, 0.3), 1, 0.1);
  for (const char* name : {"E11", "E22", "E33", "E12", "E13", "E23"}) {
    std::vector<double> at;
    for (int i = 0; i < 15; ++i) at.push_back(-0.2 + 0.04 * i);
    add_addend(model, name, at, {}, VectorXd::LinSpaced(15, 0.01, 0.03));
  }
  add_addend(model, "E11_E22", {-0.1, 0.1, 0.3}, {0.0, 0.2}, VectorXd::Constant(6, 0.002));
  return model;
}

void newton_iteration(benchmark::State& state) {
  const auto mesh =
      std::make_shared<TetMesh>(test::block(8, 8, 16, Eigen::Vector3d(20, 20, 40), 2, 0.2));
  EnergyModel energy;
  const AdditiveModel model = hundred();
  energy.parts.push_back({state.range(0) ? additive(model) : neo_hookean(0.05, 0.5), {}});
  Assembly assembly(*mesh);
  VectorXd q(3 * mesh->nodes());
  for (int a = 0; a < mesh->nodes(); ++a) {
    const Eigen::Vector3d X = mesh->X.col(a);
    q.segment<3>(3 * a) = Eigen::Vector3d(X.x() + 0.001 * X.z() * X.z(), X.y() - 0.02 * X.x(),
                                          1.1 * X.z() + 0.0005 * X.x() * X.y());
  }
  std::vector<int> free;
  for (int a = 0; a < mesh->nodes(); ++a)
    for (int i = 0; i < 3 && mesh->X(2, a) > 1e-6; ++i) free.push_back(3 * a + i);
  SparseMatrix K = assembly.zero_tangent();
  assembly.set_tangent(energy, q, false, K);
  TangentFactor factor(std::make_shared<SymbolicFactor>(K, free));
  const VectorXd b = VectorXd::Ones(static_cast<Eigen::Index>(free.size()));
  VectorXd x, R;
  for (auto _ : state) {
    benchmark::DoNotOptimize(assembly.energy(energy, q));
    benchmark::DoNotOptimize(assembly.smallest_J(q));
    R = VectorXd::Zero(q.size());
    assembly.add_forces(energy, q, R);
    assembly.set_tangent(energy, q, false, K);
    benchmark::DoNotOptimize(factor.factorize(K));
    factor.solve(b, x);
  }
  state.counters["values"] = energy.parts[0].term->size();
  state.counters["unknowns"] = static_cast<double>(q.size());
  state.SetLabel(energy.parts[0].term->name());
}
/// The step of a Gauss-Newton iteration over 100 control values: the minimum of a quadratic model
/// over convex energies, from a target that is not convex.
void convex_projection(benchmark::State& state) {
  const AdditiveModel model = hundred();
  const int n = model.size();
  const std::vector<ConvexPart> parts = {{model, Eigen::MatrixXd::Identity(n, n)}};
  // What fits see: values beside one another share much of what they do to the pictures.
  Eigen::MatrixXd metric(n, n);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) metric(i, k) = std::pow(0.8, std::abs(i - k));
  std::srand(1);
  const VectorXd target = model.values() + 0.02 * VectorXd::Random(n);
  ConvexProjection found;
  for (auto _ : state) found = project_convex(parts, target, metric);
  state.counters["cuts"] = found.cuts;
  state.counters["converged"] = found.converged;
}
BENCHMARK(convex_projection)->Unit(benchmark::kMillisecond);
BENCHMARK(newton_iteration)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// Force derivatives by all control values at fixed q.
void control_value_columns(benchmark::State& state) {
  const auto mesh =
      std::make_shared<TetMesh>(test::block(8, 8, 16, Eigen::Vector3d(20, 20, 40), 2, 0.2));
  EnergyModel energy;
  energy.parts.push_back({additive(hundred()), {}});
  const Assembly assembly(*mesh);
  const VectorXd q = 1.1 * mesh->X.reshaped();
  for (auto _ : state) benchmark::DoNotOptimize(assembly.all_dR_dtheta(energy, q, 0));
}
BENCHMARK(control_value_columns)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hookeye
