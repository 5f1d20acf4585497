// What all that is solved or assembled on one mesh shares.
#pragma once

#include <memory>

#include "simulation/assembly.h"
#include "simulation/newton.h"

namespace hookeye {

/// A capture has one solver a load case.
struct OfMesh {
  Assembly assembly;
  std::shared_ptr<SymbolicFactors> symbolic;
  /// With its pattern built, so that nothing changes it any more.
  explicit OfMesh(const TetMesh& mesh);
};

/// The one that another solver of this mesh has, else a new one. A mesh that its pointer does not
/// own may be gone, and another at its place.
std::shared_ptr<OfMesh> of_mesh(const std::shared_ptr<const TetMesh>& mesh);

/// The assembly of that, where somebody has one, else a new one.
std::shared_ptr<Assembly> assembly_of(const TetMesh& mesh);

}  // namespace hookeye
