// The energy of the whole body: a sum of terms, each weighted over the elements, and swelling.
#pragma once

#include <memory>
#include <vector>

#include "meshing/tet_mesh.h"
#include "simulation/energy_term.h"

namespace hookeye {

/// psi(X, F) = sum_parts weight_e * g^3 * term.psi(F / g), g = swelling stretch of the element
/// (F = F_elastic * g I; multiplicative growth, Rodriguez, Hoger, McCulloch 1994).
struct EnergyModel {
  struct Part {
    std::shared_ptr<const EnergyTerm> term;
    VectorXd weight;  ///< one per element, or empty: 1 everywhere
  };
  std::vector<Part> parts;
  VectorXd swelling;  ///< linear stretch g, one per element, or empty: 1 everywhere
};

}  // namespace hookeye
