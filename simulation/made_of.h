// What terms behind their interfaces are made of, for those who write them for another program.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "simulation/energy_term.h"
#include "simulation/loading.h"

namespace hookeye {

/// follower_pressure(): columns of the mesh's boundary with the fraction of each that it acts on.
struct PressureOn {
  std::vector<std::pair<int, double>> faces;
  double pressure = 0.0;  ///< inwards [stress]
};
/// elastic_foundation().
struct FoundationOn {
  std::vector<std::pair<int, double>> faces;
  double k_normal = 0.0, k_tangent = 0.0;  ///< [stress/length]
  VectorXd target;                         ///< 3n positions at which the springs are at rest
};
/// floor_contact().
struct FloorPlane {
  Vector3d point, normal;  ///< the half space that the normal points into is free
  double k = 0.0;          ///< [stress/length]
  double smoothing = 0.0;  ///< [length]
};

/// Empty: the term is another.
std::optional<PressureOn> as_pressure(const ForceTerm& force);
std::optional<FoundationOn> as_foundation(const ForceTerm& force);
std::optional<FloorPlane> as_floor(const ForceTerm& force);

/// The terms of a combination(); null: the law is another.
const std::vector<WeightedTerm>* terms_of(const EnergyTerm& law);

}  // namespace hookeye
