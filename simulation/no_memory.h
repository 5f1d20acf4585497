// What is said where a body has more unknowns than the memory takes.
#pragma once

#include "simulation/sparse_factor.h"

namespace hookeye {

/// "out of memory: ..." with the unknowns, what they need, what there is, and the edge of a mesh
/// that would fit. `error`: an OutOfMemory, or what another allocation threw. `symbolic`: null
/// where it ended before the factor's size was known, which is estimated then.
NumericalFailure no_memory(const TetMesh& mesh, const Loading& loading, const std::bad_alloc& error,
                           const SymbolicFactor* symbolic);

}  // namespace hookeye
