// How hookeye-mpi solves with tangents: --solver.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace hookeye {

/// PETSc from the first body that needs it to the end of this.
class Solver {
 public:
  Solver();
  /// After everything that was solved is gone.
  ~Solver();
  /// The default first.
  static std::vector<std::string> names() { return {"auto", "direct", "multigrid"}; }
  /// Throws InputError where this program cannot.
  void choose(const std::string& name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
