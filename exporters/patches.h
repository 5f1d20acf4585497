// Supports and loads told by patches of faces, for programs that know none at nodes. For this
// folder alone.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "exporters/solver_model.h"

namespace hookeye {

struct Patch {
  std::string name;
  std::vector<int> faces;  ///< whole columns of the boundary, ascending
  double area = 0.0;       ///< of these faces at rest [length^2]
};

struct HeldPatch {
  size_t patch;
  /// Displacement by component as an expression of x, y, z and t, the share of the load; "": free.
  std::array<std::string, 3> motion;
};

/// Indices are those of Patches::all.
struct CasePatches {
  std::vector<HeldPatch> held;
  std::vector<std::pair<size_t, Vector3d>> tractions;  ///< dead [stress]
  std::vector<std::pair<size_t, double>> pressures;    ///< inwards [stress]
};

struct Patches {
  std::vector<Patch> all;
  std::vector<CasePatches> cases;  ///< order of the model's
  std::vector<std::string> lacks;
};

/// Faces count whole where more than half of them is in a region; loads keep their sums.
Patches patches_of(const SolverModel& model);

}  // namespace hookeye
