// The only file that touches CHOLMOD and METIS.
//
// The order is METIS's nested dissection of the graph of nodes, expanded to unknowns: the same fill
// as on the unknowns' graph at half the time, and 2-3 times less work than AMD at 30,000 unknowns.
// Factors have CHOLMOD's long indices: 32 bits end at 2^31 values, and a block of 1.5 million
// unknowns has some 4e9. K and the graph of nodes have less than that, and METIS's own indices are
// short. CHOLMOD's supernodal loop opens OpenMP threads that fight over the cores, so it runs with
// OpenMP regions inactive and BLAS at one thread; the cores are used one example each.
#include "simulation/sparse_factor.h"

#include <cholmod.h>
#include <metis.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>

#include "core/memory_left.h"

// Weak: another BLAS may stand in for OpenBLAS.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));

namespace hookeye {
namespace {

using Long = SuiteSparse_long;

/// Makes OpenMP regions run on the calling thread while it lives.
class SerialOpenMp {
 public:
  SerialOpenMp() : levels_(omp_get_max_active_levels()) {
    omp_set_max_active_levels(0);
    if (openblas_set_num_threads) openblas_set_num_threads(1);
  }
  ~SerialOpenMp() { omp_set_max_active_levels(levels_); }

 private:
  int levels_;
};

struct Common {
  Common() {
    cholmod_l_start(&c);
    c.nmethods = 1;
    c.method[0].ordering = CHOLMOD_GIVEN;
    c.postorder = 1;
    c.supernodal = CHOLMOD_SUPERNODAL;
    c.final_ll = 1;
    c.print = 0;
  }
  ~Common() { cholmod_l_finish(&c); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
  /// After a call that took `bytes`: it may have failed for want of room, which is no fault of the
  /// matrix.
  void demand_room(double bytes) const {
    if (c.status == CHOLMOD_OUT_OF_MEMORY || c.status == CHOLMOD_TOO_LARGE)
      throw OutOfMemory(bytes, memory_left());
  }
  cholmod_common c;
};

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

/// Nested dissection of the nodes that have free unknowns; order[k] = index in `free`.
std::vector<Long> dissect(const SparseMatrix& K, const std::vector<int>& free,
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
  std::vector<Long> order;
  order.reserve(free.size());
  for (idx_t k = 0; k < n; ++k)
    for (int c = 0; c < 3; ++c)
      if (const int u = index[3 * nodes[permutation[k]] + c]; u >= 0) order.push_back(u);
  return order;
}

}  // namespace

struct SymbolicFactor::Impl {
  Common common;
  std::vector<int> free, index;  ///< unknown of a free one and back (-1: prescribed)
  std::vector<Long> start, row;  ///< K_ff, upper triangle by columns: CHOLMOD permutes it at once
  std::vector<int> gather;       ///< value of K for each value of the upper triangle
  Eigen::Index nonzeros = 0, columns = 0;
  size_t fingerprint = 0;
  cholmod_factor* factor = nullptr;
  ~Impl() { cholmod_l_free_factor(&factor, &common.c); }

  void take_pattern(const SparseMatrix& K);
  /// Of the upper triangle, from K's lower one: where both halves differ in the last digit it
  /// counts.
  std::vector<double> values_of(const SparseMatrix& K, double shift) const;

  cholmod_sparse view(double* values) {
    cholmod_sparse A{};
    A.nrow = A.ncol = free.size();
    A.nzmax = row.size();
    A.p = start.data();
    A.i = row.data();
    A.x = values;
    A.stype = 1;
    A.itype = CHOLMOD_LONG;
    A.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
    A.dtype = CHOLMOD_DOUBLE;
    A.sorted = A.packed = 1;
    return A;
  }
};

void SymbolicFactor::Impl::take_pattern(const SparseMatrix& K) {
  const auto each_below = [&](auto&& told) {  // what lies on and below the diagonal, by columns
    for (int u : free)
      for (int k = K.outerIndexPtr()[u]; k < K.outerIndexPtr()[u + 1]; ++k)
        if (const int below = index[K.innerIndexPtr()[k]]; below >= index[u])
          told(below, index[u], k);
  };
  start.assign(free.size() + 1, 0);
  each_below([&](int below, int, int) { ++start[below + 1]; });
  for (size_t u = 0; u < free.size(); ++u) start[u + 1] += start[u];
  // Each value, its inner indices, and the permuted copies that the analysis makes of these.
  demand_memory(static_cast<double>(start.back()) * (sizeof(int) + 3 * sizeof(Long)));
  row.resize(start.back());
  gather.resize(start.back());
  std::vector<Long> next(start.begin(), start.end() - 1);
  each_below([&](int below, int column, int k) {  // rows of a column come in order
    const Long at = next[below]++;
    row[at] = column;
    gather[at] = k;
  });
}

std::vector<double> SymbolicFactor::Impl::values_of(const SparseMatrix& K, double shift) const {
  std::vector<double> values(gather.size());
  for (size_t i = 0; i < gather.size(); ++i) values[i] = K.valuePtr()[gather[i]];
  if (shift != 0)  // columns end with their diagonal
    for (size_t u = 0; u < free.size(); ++u) values[start[u + 1] - 1] += shift;
  return values;
}

/// FNV-1a over the row indices: tells patterns of the same size apart.
static size_t fingerprint_of(const SparseMatrix& K) {
  size_t h = 1469598103934665603ull;
  for (Eigen::Index i = 0; i < K.nonZeros(); ++i)
    h = (h ^ static_cast<size_t>(K.innerIndexPtr()[i])) * 1099511628211ull;
  return h;
}

SymbolicFactor::SymbolicFactor(const SparseMatrix& K, std::vector<int> free)
    : impl_(std::make_unique<Impl>()) {
  Impl& s = *impl_;
  s.free = std::move(free);
  s.nonzeros = K.nonZeros();
  s.columns = K.cols();
  s.fingerprint = fingerprint_of(K);
  s.index.assign(K.cols(), -1);
  for (size_t i = 0; i < s.free.size(); ++i) s.index[s.free[i]] = static_cast<int>(i);
  s.take_pattern(K);
  std::vector<Long> order = dissect(K, s.free, s.index);
  const SerialOpenMp serial;
  cholmod_sparse A = s.view(nullptr);
  s.factor = cholmod_l_analyze_p(&A, order.data(), nullptr, 0, &s.common.c);
  s.common.demand_room(static_cast<double>(2 * sizeof(Long) * s.row.size()));
  if (!s.factor) throw std::runtime_error("CHOLMOD cannot analyse the tangent");
}

SymbolicFactor::~SymbolicFactor() = default;
const std::vector<int>& SymbolicFactor::free() const { return impl_->free; }
bool SymbolicFactor::fits(const SparseMatrix& K, const std::vector<int>& free) const {
  return K.cols() == impl_->columns && K.nonZeros() == impl_->nonzeros && free == impl_->free &&
         fingerprint_of(K) == impl_->fingerprint;
}

FactorMemory SymbolicFactor::memory() const {
  const Impl& s = *impl_;
  const cholmod_factor& L = *s.factor;
  const double n = static_cast<double>(s.free.size()), values = static_cast<double>(s.row.size());
  FactorMemory out;
  out.factor = sizeof(double) * static_cast<double>(L.xsize) +
               sizeof(Long) * (static_cast<double>(L.ssize + 3 * L.nsuper) + 2 * n);
  // The values of K_ff, their permuted copy with its indices, the largest update of a supernode,
  // and what a solve has of vectors.
  out.beside = (2 * sizeof(double) + sizeof(Long)) * values +
               sizeof(double) * static_cast<double>(L.maxcsize) + 8 * sizeof(Long) * n;
  return out;
}

namespace {
std::atomic<int64_t> bytes_of_factors = 0;
}

double memory_of_factors() { return static_cast<double>(bytes_of_factors); }

struct TangentFactor::Impl {
  Common common;
  cholmod_factor* factor = nullptr;
  cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;  ///< workspaces of solve2
  bool positive = false;
  int64_t counted = 0;  ///< of this factor, in bytes_of_factors

  void count(double bytes) {
    bytes_of_factors += static_cast<int64_t>(bytes) - counted;
    counted = static_cast<int64_t>(bytes);
  }
  void drop() {
    cholmod_l_free_factor(&factor, &common.c);
    count(0.0);
  }
  ~Impl() {
    drop();
    cholmod_l_free_dense(&X, &common.c);
    cholmod_l_free_dense(&Y, &common.c);
    cholmod_l_free_dense(&E, &common.c);
  }
};

TangentFactor::TangentFactor(std::shared_ptr<const SymbolicFactor> symbolic)
    : symbolic_(std::move(symbolic)), impl_(std::make_unique<Impl>()) {}
TangentFactor::~TangentFactor() = default;
bool TangentFactor::positive() const { return impl_->positive; }

bool TangentFactor::factorize(const SparseMatrix& K, double shift) {
  SymbolicFactor::Impl& s = symbolic_->impl();
  cholmod_common& c = impl_->common.c;
  impl_->positive = false;
  if (impl_->factor && !impl_->factor->is_super) impl_->drop();
  const FactorMemory memory = symbolic_->memory();
  const double needed = memory.beside + (impl_->factor ? 0.0 : memory.factor);
  const MemoryClaim claim(needed);
  std::vector<double> values = s.values_of(K, shift);
  const SerialOpenMp serial;
  if (!impl_->factor) {
    impl_->factor = cholmod_l_copy_factor(s.factor, &c);
    impl_->common.demand_room(needed);
    impl_->count(memory.factor);
  }
  cholmod_sparse A = s.view(values.data());
  const bool done = cholmod_l_factorize(&A, impl_->factor, &c);
  impl_->common.demand_room(needed);
  impl_->positive = done && c.status == CHOLMOD_OK && impl_->factor->minor == s.free.size();
  return impl_->positive;
}

bool TangentFactor::factorize_indefinite(const SparseMatrix& K) {
  SymbolicFactor::Impl& s = symbolic_->impl();
  cholmod_common& c = impl_->common.c;
  impl_->drop();
  impl_->positive = false;
  // Values and indices of a factor column by column, with room to grow.
  const double needed =
      1.2 * (sizeof(double) + sizeof(Long)) * s.common.c.lnz + symbolic_->memory().beside;
  const MemoryClaim claim(needed);
  std::vector<double> values = s.values_of(K, 0.0);
  const SerialOpenMp serial;
  c.supernodal = CHOLMOD_SIMPLICIAL;
  c.final_ll = 0;
  cholmod_sparse A = s.view(values.data());
  std::vector<Long> order(static_cast<Long*>(s.factor->Perm),
                          static_cast<Long*>(s.factor->Perm) + s.free.size());
  impl_->factor = cholmod_l_analyze_p(&A, order.data(), nullptr, 0, &c);
  impl_->count(needed);
  const bool done = impl_->factor && cholmod_l_factorize(&A, impl_->factor, &c);
  const bool regular = done && c.status == CHOLMOD_OK && impl_->factor->minor == s.free.size();
  c.supernodal = CHOLMOD_SUPERNODAL;
  c.final_ll = 1;
  impl_->common.demand_room(needed);
  return regular;
}

namespace {
/// Right-hand sides per block: enough for BLAS 3, few enough to stay in cache.
constexpr Eigen::Index kColumnsAtOnce = 32;

void solve_block(const double* b, double* x, Eigen::Index n, Eigen::Index m, cholmod_factor* L,
                 cholmod_dense** X, cholmod_dense** Y, cholmod_dense** E, cholmod_common* c) {
  cholmod_dense B{};
  B.nrow = B.d = n;
  B.ncol = m;
  B.nzmax = n * m;
  B.x = const_cast<double*>(b);
  B.xtype = CHOLMOD_REAL;
  B.dtype = CHOLMOD_DOUBLE;
  if (!cholmod_l_solve2(CHOLMOD_A, L, &B, nullptr, X, nullptr, Y, E, c))
    throw OutOfMemory(static_cast<double>(3 * sizeof(double) * n * m), memory_left());
  std::copy_n(static_cast<const double*>((*X)->x), n * m, x);
}
}  // namespace

void TangentFactor::solve(const MatrixXd& B, MatrixXd& X) const {
  X.resize(B.rows(), B.cols());
  if (B.rows() == 0) return;
  const SerialOpenMp serial;
  Impl& w = *impl_;
  for (Eigen::Index j = 0; j < B.cols(); j += kColumnsAtOnce) {
    const Eigen::Index m = std::min(kColumnsAtOnce, B.cols() - j);
    solve_block(B.col(j).data(), X.col(j).data(), B.rows(), m, w.factor, &w.X, &w.Y, &w.E,
                &w.common.c);
  }
}

void TangentFactor::solve(const VectorXd& b, VectorXd& x) const {
  x.resize(b.size());
  if (b.size() == 0) return;
  const SerialOpenMp serial;
  Impl& w = *impl_;
  solve_block(b.data(), x.data(), b.size(), 1, w.factor, &w.X, &w.Y, &w.E, &w.common.c);
}

double TangentFactor::factor_nonzeros() const {
  return impl_->factor ? static_cast<double>(impl_->factor->xsize) : 0.0;
}

}  // namespace hookeye
