// Equilibrium and sensitivities of bench/unknowns' block: bench_unknowns MESH SOLVER [OUT [KAPPA]]
// prints what each took, and writes positions and sensitivities (doubles) to OUT.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <fstream>
#include <map>

#include "simulation/petsc/multigrid.h"
#include "simulation/sparse_factor.h"

namespace hookeye {
namespace {

rusage used() {
  rusage now{};
  getrusage(RUSAGE_SELF, &now);
  return now;
}
double cpu_seconds() {
  const rusage now = used();
  return static_cast<double>(now.ru_utime.tv_sec + now.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(now.ru_utime.tv_usec + now.ru_stime.tv_usec);
}

struct Block {
  TetMesh mesh;
  double mu = 0.03, kappa = 0.14;
  Vector3d gravity{0, 0, -9810};

  EnergyModel energy() const {
    EnergyModel model;
    model.parts.push_back({neo_hookean(mu, kappa), {}});
    return model;
  }
  Loading loading() const {
    Loading l;
    for (int a = 0; a < mesh.nodes(); ++a)
      if (std::abs(mesh.X(0, a)) < 1e-6)
        for (int i = 0; i < 3; ++i) l.prescribed.push_back(3 * a + i);
    l.displacement = VectorXd::Zero(static_cast<Eigen::Index>(l.prescribed.size()));
    l.forces.push_back(self_weight(mesh, 1.07e-9, gravity));
    return l;
  }
  /// By both moduli and the three components of gravity, 3n x 5.
  Eigen::MatrixXd dR_dp(const VectorXd& q) const {
    Eigen::MatrixXd dR(q.size(), 5);
    const EnergyModel model = energy();
    for (int k = 0; k < 2; ++k) dR.col(k) = hookeye::dR_dtheta(mesh, model, q, 0, k);
    for (int k = 0; k < 3; ++k) {
      Loading unit;
      unit.forces.push_back(self_weight(mesh, 1.07e-9, Vector3d::Unit(k)));
      dR.col(2 + k) = residual(mesh, {}, unit, q);
    }
    return dR;
  }
};

void write(const char* file, const VectorXd& q, const Eigen::MatrixXd& S) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(q.data()), q.size() * 8);
  out.write(reinterpret_cast<const char*>(S.data()), S.size() * 8);
}

int run(int argc, char** argv) {
  const std::map<std::string, SolverChoice> choices = {{"auto", SolverChoice::automatic},
                                                       {"direct", SolverChoice::direct},
                                                       {"multigrid", SolverChoice::multigrid}};
  if (argc < 3 || !choices.contains(argv[2])) {
    fmt::print(stderr, "bench_unknowns MESH auto|direct|multigrid [OUT [KAPPA]]\n");
    return 2;
  }
  spdlog::set_default_logger(spdlog::stderr_logger_mt("bench"));
  spdlog::set_pattern("%l: %v");
  spdlog::set_level(spdlog::level::debug);
  const PetscSession session;
  use_large_solver(choices.at(argv[2]), petsc_solver);
  Block block{read_volume(argv[1], {argv[1]})};
  if (argc > 4) block.kappa = std::stod(argv[4]);
  const double start = cpu_seconds();
  const Loading loading = block.loading();
  const auto solved = solve_equilibrium(block.mesh, block.energy(), loading);
  if (!solved) {
    fmt::print(stderr, "{}\n", solved.error().reason);
    return 3;
  }
  const double there = cpu_seconds();
  const Eigen::MatrixXd dR = block.dR_dp(solved->q);
  const double before = cpu_seconds();
  const Eigen::MatrixXd S = sensitivities(*solved, loading, dR, {});
  const double end = cpu_seconds();
  fmt::print(
      R"({{"unknowns": {}, "multigrid": {}, "newton": {}, "factors": {}, "equilibrium_s": {:.4g}, )"
      R"("sensitivities_s": {:.4g}, "gb": {:.4g}, "stable": {}}})"
      "\n",
      3 * block.mesh.nodes(), solved->factor->iterates(), solved->newton_iterations,
      solved->factorizations, there - start, end - before,
      static_cast<double>(used().ru_maxrss) * 1024e-9, solved->stable);
  if (argc > 3) write(argv[3], solved->q, S);
  return 0;
}

}  // namespace
}  // namespace hookeye

int main(int argc, char** argv) { return hookeye::run(argc, argv); }
