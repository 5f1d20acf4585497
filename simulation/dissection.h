// Fill-reducing order of a factor.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/equilibrium.h"

namespace hookeye {

/// Nested dissection of the nodes that have free unknowns; order[k] = index in `free`. `index`: of
/// every unknown in `free`, -1: it is not there.
std::vector<std::int64_t> dissect(const SparseMatrix& K, const std::vector<int>& free,
                                  const std::vector<int>& index);

}  // namespace hookeye
