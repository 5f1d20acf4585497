#include "simulation/large_solver.h"

#include <cmath>

namespace hookeye {
namespace {

LargeSolvers& chosen() {
  static LargeSolvers solvers;
  return solvers;
}

}  // namespace

void use_large_solver(SolverChoice when, MakeLargeSolver make) {
  chosen() = {make ? when : SolverChoice::direct, std::move(make)};
}

const LargeSolvers& large_solvers() { return chosen(); }

Eigen::Matrix2Xi ends_of(const TetMesh& mesh) {
  Eigen::Matrix2Xi ends(2, mesh.nodes());
  for (int a = 0; a < mesh.nodes(); ++a) ends.col(a).setConstant(a);
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};
  if (mesh.order == 2)
    for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e)
      for (int i = 0; i < 6; ++i)
        ends.col(mesh.elements(4 + i, e)) << mesh.elements(kEdges[i][0], e),
            mesh.elements(kEdges[i][1], e);
  return ends;
}

double factor_estimate(double unknowns) {
  return 2500.0 * unknowns + 130.0 * std::pow(unknowns, 4.0 / 3.0);
}

}  // namespace hookeye
