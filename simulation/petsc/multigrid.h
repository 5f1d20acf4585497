// Bodies whose factor is too large: multigrid, and MUMPS where that does not serve.
#pragma once

#include "simulation/large_solver.h"
#include "simulation/petsc/parts.h"

namespace hookeye {

/// Conjugate gradients on the quadratic elements, preconditioned by one cycle: smoothing there,
/// linear tetrahedra of the same corners below, algebraic multigrid below them. Where iterations
/// stagnate, as with nearly incompressible laws, K is factored by MUMPS and is ever after.
/// A PetscSession must live as long.
std::unique_ptr<LargeSolver> petsc_solver(std::shared_ptr<const LargeBody> body);

}  // namespace hookeye
