// Equilibria of small blocks: an energy, supports, and a block with every load at once.
#pragma once

#include <gtest/gtest.h>

#include "simulation/blocks.h"
#include "simulation/equilibrium.h"

namespace hookeye::test {

inline EnergyModel of(std::shared_ptr<const EnergyTerm> law) {
  EnergyModel energy;
  energy.parts.push_back({std::move(law), {}});
  return energy;
}

/// The boundary faces at X[axis] = at.
inline Region plane(const TetMesh& mesh, int axis, double at) {
  return region_where(mesh, [=](const Vector3d& X) { return std::abs(X[axis] - at) < 1e-9; });
}

inline void hold(const TetMesh& mesh, const Region& region, Loading& loading) {
  for (int i = 0; i < 3; ++i) loading.prescribe(mesh, region, i, 0);
}

/// Fails the test where there is no equilibrium.
inline Equilibrium solve(const TetMesh& mesh, const EnergyModel& energy, const Loading& loading,
                         double tolerance = 1e-11) {
  EquilibriumOptions options;
  options.tolerance = tolerance;
  auto result = solve_equilibrium(mesh, energy, loading, options);
  if (!result) {
    ADD_FAILURE() << result.error().reason << " at " << result.error().load_fraction;
    return {};
  }
  return *std::move(result);
}

/// A bent, loaded block: everything at once.
struct BentBlock {
  TetMesh mesh = block(3, 1, 2, {4, 2, 2}, 2);
  Region base = plane(mesh, 0, 0), tip = plane(mesh, 0, 4), side = plane(mesh, 2, 2);
  double lift = 0.6, gravity = 0.004, pressure = 0.002, spring = 0.01, swelling = 1.03;
  VectorXd theta;
  std::shared_ptr<const EnergyTerm> law = neo_hookean(0.05, 0.6);

  EnergyModel energy() const {
    EnergyModel model = of(theta.size() ? law->with(theta) : law);
    model.swelling = VectorXd::Constant(mesh.size(), swelling);
    return model;
  }
  Loading loading() const {
    Loading l;
    hold(mesh, base, l);
    l.prescribe(mesh, tip, 2, lift);
    l.forces = {
        self_weight(mesh, 1.0, Vector3d(0, gravity, 0)), dead_force(tip, Vector3d(0.02, 0, 0)),
        follower_pressure(region_where(mesh, [](const Vector3d&) { return true; }), pressure),
        elastic_foundation(side, spring, 0.5 * spring, mesh.X.reshaped())};
    return l;
  }
  Equilibrium solved() const { return solve(mesh, energy(), loading()); }
};

}  // namespace hookeye::test
