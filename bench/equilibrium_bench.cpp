// Equilibrium against its floor (raw CHOLMOD + METIS) on the shared reference block, CPU seconds of
// one thread. Run: bench_simulation --benchmark_min_time=2. The ratios of design/speed.md:
// factor / raw, sensitivities / factor, warm / factor. Against CalculiX: bench/compare_ccx.sh.
#include <benchmark/benchmark.h>
#include <cholmod.h>
#include <omp.h>

#include <Eigen/Dense>
#include <fstream>

#include "simulation/assembly.h"
#include "simulation/problem.h"
#include "simulation/sparse_factor.h"
#include "support/shared_data.h"

namespace hookeye {
namespace {

std::shared_ptr<TetMesh> read_block(const std::string& name) {
  std::ifstream in(test::shared_data() / "reference" / (name + ".mesh"));
  int n = 0, m = 0, npe = 0;
  in >> n >> m >> npe;
  auto mesh = std::make_shared<TetMesh>();
  mesh->order = npe == 4 ? 1 : 2;
  mesh->X.resize(3, n);
  mesh->elements.resize(npe, m);
  for (double& x : mesh->X.reshaped()) in >> x;
  for (int& a : mesh->elements.reshaped()) in >> a;
  if (!in) throw std::runtime_error("needs the reference data (set HOOKEYE_DATA)");
  return mesh;
}

EnergyModel material(double mu, double kappa) {
  EnergyModel energy;
  energy.parts.push_back({neo_hookean(mu, kappa), {}});
  return energy;
}

/// Case B: held at x = 0, own weight.
Loading cantilever(const TetMesh& mesh) {
  Loading loading;
  for (int a = 0; a < mesh.nodes(); ++a)
    for (int i = 0; i < 3 && mesh.X(0, a) < 1e-6; ++i) loading.prescribed.push_back(3 * a + i);
  loading.displacement = VectorXd::Zero(static_cast<Eigen::Index>(loading.prescribed.size()));
  loading.forces.push_back(self_weight(mesh, 1.07e-9, Vector3d(0, 0, -9810)));
  return loading;
}

struct Solved {
  std::shared_ptr<TetMesh> mesh = read_block("q30k");
  EnergyModel energy = material(0.03, 0.14);
  Loading loading = cantilever(*mesh);
  Equilibrium equilibrium = solve_equilibrium(*mesh, energy, loading).value();
};
const Solved& solved() {
  static const Solved s;
  return s;
}

/// The floor: CHOLMOD's own METIS order on the unknowns' graph, one thread.
struct Raw {
  cholmod_common c;
  cholmod_sparse* A;
  cholmod_factor* L;
  explicit Raw(const Equilibrium& e) {
    cholmod_start(&c);
    c.nmethods = 1;
    c.method[0].ordering = CHOLMOD_METIS;
    c.supernodal = CHOLMOD_SUPERNODAL;
    const auto& free = e.factor->free();
    std::vector<int> index(e.K.cols(), -1);
    for (size_t i = 0; i < free.size(); ++i) index[free[i]] = static_cast<int>(i);
    A = cholmod_allocate_sparse(free.size(), free.size(), e.K.nonZeros(), 1, 1, -1, CHOLMOD_REAL,
                                &c);
    int next = 0, column = 0;
    for (int u : free) {
      static_cast<int*>(A->p)[column++] = next;
      for (SparseMatrix::InnerIterator it(e.K, u); it; ++it)
        if (index[it.row()] >= index[u]) {
          static_cast<int*>(A->i)[next] = index[it.row()];
          static_cast<double*>(A->x)[next++] = it.value();
        }
    }
    static_cast<int*>(A->p)[column] = next;
    L = cholmod_analyze(A, &c);
  }
  ~Raw() {
    cholmod_free_factor(&L, &c);
    cholmod_free_sparse(&A, &c);
    cholmod_finish(&c);
  }
};

void raw_cholmod_factor(benchmark::State& state) {
  Raw raw(solved().equilibrium);
  omp_set_max_active_levels(0);
  for (auto _ : state) cholmod_factorize(raw.A, raw.L, &raw.c);
  omp_set_max_active_levels(1);
  state.counters["nnz_L"] = static_cast<double>(raw.L->xsize);
}

void factor(benchmark::State& state) {
  TangentFactor f(solved().equilibrium.factor->symbolic());
  for (auto _ : state) benchmark::DoNotOptimize(f.factorize(solved().equilibrium.K));
  state.counters["nnz_L"] = f.factor_nonzeros();
}

void symbolic(benchmark::State& state) {
  const auto& e = solved().equilibrium;
  for (auto _ : state) SymbolicFactor(e.K, e.factor->free());
}

void sensitivity(benchmark::State& state) {
  const auto& s = solved();
  const Eigen::MatrixXd dR = Eigen::MatrixXd::Random(3 * s.mesh->nodes(), state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(sensitivities(s.equilibrium, s.loading, dR, Eigen::MatrixXd()));
}

void assemble_tangent(benchmark::State& state) {
  const auto& s = solved();
  Assembly assembly(*s.mesh);
  SparseMatrix K = assembly.zero_tangent();
  for (auto _ : state) assembly.set_tangent(s.energy, s.equilibrium.q, false, K);
}

void assemble_forces(benchmark::State& state) {
  const auto& s = solved();
  const Assembly assembly(*s.mesh);
  VectorXd R = VectorXd::Zero(3 * s.mesh->nodes());
  for (auto _ : state) assembly.add_forces(s.energy, s.equilibrium.q, R);
}

void assemble_energy(benchmark::State& state) {
  const auto& s = solved();
  const Assembly assembly(*s.mesh);
  for (auto _ : state) benchmark::DoNotOptimize(assembly.energy(s.energy, s.equilibrium.q));
}

void smallest_J(benchmark::State& state) {
  const auto& s = solved();
  const Assembly assembly(*s.mesh);
  for (auto _ : state) benchmark::DoNotOptimize(assembly.smallest_J(s.equilibrium.q));
}

/// One step of 5 % in both moduli (range 0: mu only), there and back in turn.
void warm_step(benchmark::State& state) {
  const auto& s = solved();
  EquilibriumSolver solver(s.mesh);
  solver.solve(s.energy, s.loading);
  bool up = true;
  int factorizations = 0;
  for (auto _ : state) {
    const double f = up ? 1.05 : 1.0;
    const auto e = solver.solve(material(0.03 * f, state.range(0) ? 0.14 * f : 0.14), s.loading);
    factorizations = e->factorizations;
    up = !up;
  }
  state.counters["factorizations"] = factorizations;
}

void cold(benchmark::State& state) {
  const auto& s = solved();
  Equilibrium e;
  for (auto _ : state) e = solve_equilibrium(*s.mesh, s.energy, s.loading).value();
  state.counters["newton"] = e.newton_iterations;
  state.counters["factorizations"] = e.factorizations;
}

BENCHMARK(raw_cholmod_factor)->Unit(benchmark::kMillisecond);
BENCHMARK(factor)->Unit(benchmark::kMillisecond);
BENCHMARK(symbolic)->Unit(benchmark::kMillisecond);
BENCHMARK(sensitivity)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(assemble_tangent)->Unit(benchmark::kMillisecond);
BENCHMARK(assemble_forces)->Unit(benchmark::kMillisecond);
BENCHMARK(assemble_energy)->Unit(benchmark::kMillisecond);
BENCHMARK(smallest_J)->Unit(benchmark::kMillisecond);
BENCHMARK(warm_step)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(cold)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hookeye

BENCHMARK_MAIN();
