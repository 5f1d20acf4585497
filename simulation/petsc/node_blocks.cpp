#include "simulation/petsc/node_blocks.h"

#include <algorithm>
#include <limits>

#include "core/memory_left.h"

namespace hookeye {
namespace {

/// Calls `each` with the rows that a node's columns have from `least` on, column by column.
template <class Each>
void each_row(const SparseMatrix& K, int node, int least, Each&& each) {
  for (int c = 0; c < 3; ++c) {
    const int u = 3 * node + c;
    const int* rows = K.innerIndexPtr();
    const int *first = rows + K.outerIndexPtr()[u], *last = rows + K.outerIndexPtr()[u + 1];
    for (const int* at = std::lower_bound(first, last, least); at != last; ++at)
      each(c, *at, K.valuePtr()[at - rows]);
  }
}

template <class T>
double bytes_of(const std::vector<T>& values) {
  return static_cast<double>(values.size()) * sizeof(T);
}

}  // namespace

NodeBlocks::NodeBlocks(const SparseMatrix& K, const std::vector<int>& free)
    : free_(K.cols(), 0), start_{0} {
  for (int u : free) free_[u] = 1;
  const int n = static_cast<int>(K.cols()) / 3;
  start_.reserve(n + 1);
  demand_memory(static_cast<double>(K.nonZeros()) / 18 * (sizeof(int) + 9 * sizeof(double)));
  column_.reserve(K.nonZeros() / 18 + n);
  std::vector<int> seen(n, -1);
  for (int a = 0; a < n; ++a) {
    each_row(K, a, 3 * a, [&](int, int row, double) {
      if (std::exchange(seen[row / 3], a) != a) column_.push_back(row / 3);
    });
    if (seen[a] != a) column_.push_back(a);
    std::sort(column_.begin() + start_.back(), column_.end());
    start_.push_back(static_cast<int>(column_.size()));
  }
}

double NodeBlocks::bytes() const {
  return bytes_of(free_) + bytes_of(start_) + bytes_of(column_) + bytes_of(values_);
}

void NodeBlocks::take(const SparseMatrix& K, double shift) {
  values_.assign(9 * column_.size(), 0.0);
  held_diagonal_ = std::max(K.diagonal().cwiseAbs().mean(), std::numeric_limits<double>::min());
  for (int a = 0; a < nodes(); ++a) {
    const int* const first = column_.data() + start_[a];
    const int* block = first;
    int last_c = -1;
    // Column u of the lower triangle is row u of the upper one.
    each_row(K, a, 3 * a, [&](int c, int row, double value) {
      if (std::exchange(last_c, c) != c) block = first;
      while (*block != row / 3) ++block;
      if (free(3 * a + c) && free(row))
        values_[9 * static_cast<size_t>(block - column_.data()) + c + 3 * (row % 3)] = value;
    });
    double* const diagonal = values_.data() + 9 * static_cast<size_t>(start_[a]);
    for (int c = 0; c < 3; ++c)
      if (free(3 * a + c))
        diagonal[4 * c] += shift;
      else
        diagonal[4 * c] = held_diagonal_;
  }
}

CornerBlocks::CornerBlocks(const SparseMatrix& K, const NodeBlocks& blocks,
                           const Eigen::Matrix2Xi& ends)
    : ends_(ends), of_node_(blocks.nodes(), -1), start_{0} {
  for (int a = 0; a < blocks.nodes(); ++a)
    for (const int end : {ends(0, a), ends(1, a)})
      if (of_node_[end] < 0) of_node_[end] = 0;
  for (int a = 0; a < blocks.nodes(); ++a)
    if (of_node_[a] == 0) {
      of_node_[a] = corners();
      node_.push_back(a);
    }
  first_child_.assign(corners() + 1, 0);
  const auto each_end = [&](auto&& each) {
    for (int a = 0; a < blocks.nodes(); ++a) {
      each(of_node_[ends(0, a)], a);
      if (ends(1, a) != ends(0, a)) each(of_node_[ends(1, a)], a);
    }
  };
  each_end([&](int corner, int) { ++first_child_[corner + 1]; });
  for (int i = 0; i < corners(); ++i) first_child_[i + 1] += first_child_[i];
  child_.resize(first_child_.back());
  std::vector<int> next(first_child_.begin(), first_child_.end() - 1), seen(corners(), -1), near;
  each_end([&](int corner, int a) { child_[next[corner]++] = a; });
  for (int i = 0; i < corners(); ++i) {
    near.assign(1, i);
    seen[i] = i;
    for (int k = first_child_[i]; k < first_child_[i + 1]; ++k)
      each_row(K, child_[k], 0, [&](int, int row, double) {
        for (const int end : {ends(0, row / 3), ends(1, row / 3)})
          if (std::exchange(seen[of_node_[end]], i) != i) near.push_back(of_node_[end]);
      });
    std::sort(near.begin(), near.end());
    for (int r = 0; r < 3; ++r) {
      for (const int j : near)
        for (int c = 0; c < 3; ++c) column_.push_back(3 * j + c);
      start_.push_back(static_cast<int>(column_.size()));
    }
  }
}

double CornerBlocks::bytes() const {
  return 2.0 * sizeof(int) * static_cast<double>(ends_.cols()) + bytes_of(node_) +
         bytes_of(of_node_) + bytes_of(first_child_) + bytes_of(child_) + bytes_of(start_) +
         bytes_of(column_) + bytes_of(values_);
}

void CornerBlocks::take(const SparseMatrix& K, double shift, const NodeBlocks& blocks) {
  values_.assign(column_.size(), 0.0);
  std::vector<int> slot(corners(), 0);  // of a corner in the row at hand
  const auto free = [&](int corner, int c) { return blocks.free(3 * node_[corner] + c); };
  for (int i = 0; i < corners(); ++i) {
    const int size = start_[3 * i + 1] - start_[3 * i];
    for (int k = 0; k < size; k += 3) slot[column_[start_[3 * i] + k] / 3] = k;
    for (int k = first_child_[i]; k < first_child_[i + 1]; ++k) {
      const int a = child_[k];
      const double weight = ends_(0, a) == ends_(1, a) ? 1.0 : 0.5;
      each_row(K, a, 0, [&](int r, int row, double value) {
        if (!free(i, r) || !blocks.free(3 * a + r) || !blocks.free(row)) return;
        if (row == 3 * a + r) value += shift;
        for (int end = 0; end < 2; ++end) {
          const int j = of_node_[ends_(end, row / 3)];
          if (free(j, row % 3))
            values_[start_[3 * i + r] + slot[j] + row % 3] += 0.5 * weight * value;
        }
      });
    }
    for (int r = 0; r < 3; ++r)
      if (!free(i, r)) values_[start_[3 * i + r] + slot[i] + r] = blocks.held_diagonal();
  }
}

}  // namespace hookeye
