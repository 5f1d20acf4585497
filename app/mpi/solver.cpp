#include "app/mpi/solver.h"

#include <mutex>

#include "core/input_error.h"
#ifdef HOOKEYE_PETSC
#include "simulation/petsc/multigrid.h"
#endif

namespace hookeye {

#ifdef HOOKEYE_PETSC

struct Solver::Impl {
  std::once_flag once;
  std::unique_ptr<PetscSession> petsc;

  std::unique_ptr<LargeSolver> solver_of(std::shared_ptr<const LargeBody> body) {
    std::call_once(once, [this] { petsc = std::make_unique<PetscSession>(); });
    return petsc_solver(std::move(body));
  }
};

void Solver::choose(const std::string& name) {
  const SolverChoice choice = name == "direct"      ? SolverChoice::direct
                              : name == "multigrid" ? SolverChoice::multigrid
                                                    : SolverChoice::automatic;
  use_large_solver(choice, [this](std::shared_ptr<const LargeBody> body) {
    return impl_->solver_of(std::move(body));
  });
}

Solver::~Solver() { use_large_solver(SolverChoice::direct, nullptr); }

#else

struct Solver::Impl {};

void Solver::choose(const std::string& name) {
  if (name == "multigrid")
    throw InputError({"--solver multigrid"}, "this hookeye-mpi was built without PETSc",
                     "--solver direct, or a hookeye-mpi that was built where petsc-dev is");
}

Solver::~Solver() = default;

#endif

Solver::Solver() : impl_(std::make_unique<Impl>()) {}

}  // namespace hookeye
