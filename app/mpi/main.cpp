// hookeye-mpi: all processes do the same, but for load cases: of those each has its own share
// (load_case_share.h). The first one's folder is the user's; the others work in copies of it.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include "app/interrupt.h"
#include "app/mpi/solver.h"
#include "app/mpi/world.h"
#include "app/program.h"
#include "app/scratch_folder.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// What a process behind the first one writes, and where it writes it.
class Behind {
 public:
  Behind() : scratch_("mpi") {
    if (!std::freopen("/dev/null", "w", stdout) ||
        !std::freopen((scratch_.path() / "said").c_str(), "w", stderr))
      throw std::runtime_error("standard output and error cannot be set aside");
  }
  /// The user's folder as it is now.
  std::string own(const std::string& folder) const {
    const fs::path copy = scratch_.path() / "run";
    if (fs::is_directory(folder) && !fs::exists(copy))
      fs::copy(folder, copy, fs::copy_options::recursive);
    return copy.string();
  }
  std::string said() const {
    std::fflush(stderr);
    std::ifstream file(scratch_.path() / "said");
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

 private:
  ScratchFolder scratch_;
};

int run(World& world, int argc, char** argv) {
  Company company;
  company.name = "hookeye-mpi";
  company.commands = {"fit", "diagnose", "discover", "simulate"};
  company.threads =
      std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / world.on_this_machine());
  std::unique_ptr<Behind> behind;
  const int true_stderr = dup(2);
  if (world.self() > 0) {
    behind = std::make_unique<Behind>();
    company.own_folder = [&](const std::string& folder) { return behind->own(folder); };
  }
  company.begins = [&](int threads) {
    world.meet();  // copies are made: the first may write
    if (world.self() == 0)
      fmt::print(stderr, "{} {} the load cases, each on {} {}\n", world.processes(),
                 world.processes() == 1 ? "process has" : "processes share", threads,
                 threads == 1 ? "core" : "cores");
  };
  auto solver = std::make_unique<Solver>();
  company.solvers = Solver::names();
  company.solve_by = [&](const std::string& name) { solver->choose(name); };
  share_load_cases(&world);
  const int status = program(argc, argv, company);
  const std::string told = behind && status != kDone ? behind->said() : "";
  solver.reset();  // PETSc ends before MPI does
  behind.reset();  // nothing stays of it where another ends this one
  if (world.self() > 0) dup2(true_stderr, 2);
  return world.end(status, told);
}

}  // namespace
}  // namespace hookeye

int main(int argc, char** argv) {
  hookeye::watch_interrupts();
  hookeye::keep_freed_memory();
  hookeye::World world(argc, argv);
  const int status = hookeye::run(world, argc, argv);
  if (status == hookeye::kNumericalFailure) hookeye::leave_at_once(status);
  return status;
}
