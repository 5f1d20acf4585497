#include "simulation/no_memory.h"

#include <fmt/format.h>

#include <cmath>

#include "core/memory_left.h"
#include "simulation/large_solver.h"

namespace hookeye {
namespace {

/// Up to two digits: 2.31 -> 2.4.
double rounded_up(double x) {
  const double digit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  return digit * std::ceil(x / digit - 1e-9);
}

/// All that is there shrinks with the number of unknowns at least, which is as the edge's cube;
/// factors shrink faster. A tenth on top, as meshes come out near their edge only.
std::string what_would_fit(const TetMesh& mesh, double needed, double there) {
  const double edge = quality(mesh).mean_edge;
  const double ratio = 1.1 * std::cbrt(needed / there);
  if (!(there > 0.0) || !(ratio < 100.0)) return "a machine with more memory is needed";
  return fmt::format("tetrahedra with an edge of {:.4g} would fit (`edge: {:.4g}`, now {:.3g})",
                     rounded_up(ratio * edge), rounded_up(ratio * edge), edge);
}

}  // namespace

NumericalFailure no_memory(const TetMesh& mesh, const Loading& loading, const std::bad_alloc& error,
                           const SymbolicFactor* symbolic) {
  const auto* told = dynamic_cast<const OutOfMemory*>(&error);
  const MemoryLeft left = told ? told->left() : memory_left();
  const double asked = told ? told->needed() : 0.0;
  double needed = std::max(asked, factor_estimate(3.0 * mesh.nodes()));
  if (symbolic) needed = told ? asked : symbolic->memory().factor + symbolic->memory().beside;
  std::string reason =
      fmt::format("out of memory: {} unknowns need {}{} more, and {} has {} left", 3 * mesh.nodes(),
                  symbolic ? "" : "about ", memory_text(needed), left.of, memory_text(left.bytes));
  const double others = memory_of_factors();
  if (others > 0.0)
    reason += fmt::format(" beside {} that factors of load cases hold", memory_text(others));
  reason += "; " + what_would_fit(mesh, needed + others, left.bytes + others);
  return {loading.name, 0.0, std::move(reason), NumericalFailure::Kind::no_memory};
}

}  // namespace hookeye
