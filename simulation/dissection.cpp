// The only file that touches METIS.
//
// The order is METIS's nested dissection of the graph of nodes, expanded to unknowns: the same fill
// as on the unknowns' graph at half the time, and 2-3 times less work than AMD at 30,000 unknowns.
#include "simulation/dissection.h"

#include <metis.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>

namespace hookeye {
namespace {

/// METIS draws from the C library's one sequence of random numbers, which it starts anew. Examples
/// that were dissected at the same time drew from one another's sequence: orders, and with them the
/// last bits of every equilibrium, came out differently from run to run.
int dissect_graph(idx_t n, std::vector<idx_t>& start, std::vector<idx_t>& near, idx_t* permutation,
                  idx_t* inverse) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 0;
  return METIS_NodeND(&n, start.data(), near.data(), nullptr, options, permutation, inverse);
}

}  // namespace

std::vector<std::int64_t> dissect(const SparseMatrix& K, const std::vector<int>& free,
                                  const std::vector<int>& index) {
  std::vector<int> nodes, compact(K.cols() / 3, -1);
  for (int u : free)
    if (nodes.empty() || nodes.back() != u / 3) {
      compact[u / 3] = static_cast<int>(nodes.size());
      nodes.push_back(u / 3);
    }
  std::vector<idx_t> start{0}, near;
  for (int a : nodes) {
    int last = -1;
    for (int c = 0; c < 3; ++c) {  // the columns of a node share their pattern, save added terms
      if (c > 0 && K.outerIndexPtr()[3 * a + c + 1] - K.outerIndexPtr()[3 * a + c] ==
                       K.outerIndexPtr()[3 * a + 1] - K.outerIndexPtr()[3 * a])
        continue;
      for (SparseMatrix::InnerIterator it(K, 3 * a + c); it; ++it) {
        const int b = static_cast<int>(it.row()) / 3;
        if (b == last || b == a || compact[b] < 0) continue;
        last = b;
        near.push_back(compact[b]);
      }
    }
    std::sort(near.begin() + start.back(), near.end());
    near.erase(std::unique(near.begin() + start.back(), near.end()), near.end());
    start.push_back(static_cast<idx_t>(near.size()));
  }
  const idx_t n = static_cast<idx_t>(nodes.size());
  std::vector<idx_t> permutation(n), inverse(n);
  if (near.empty()) {
    for (idx_t i = 0; i < n; ++i) permutation[i] = i;
  } else if (dissect_graph(n, start, near, permutation.data(), inverse.data()) != METIS_OK) {
    throw std::runtime_error("METIS_NodeND failed on the node graph");
  }
  std::vector<std::int64_t> order;
  order.reserve(free.size());
  for (idx_t k = 0; k < n; ++k)
    for (int c = 0; c < 3; ++c)
      if (const int u = index[3 * nodes[permutation[k]] + c]; u >= 0) order.push_back(u);
  return order;
}

}  // namespace hookeye
