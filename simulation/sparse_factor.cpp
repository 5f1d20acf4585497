// The only file that touches CHOLMOD.
//
// Factors have CHOLMOD's long indices: 32 bits end at 2^31 values, and a block of 1.5 million
// unknowns has some 4e9. K and the graph of nodes have less than that, and METIS's own indices are
// short. CHOLMOD's supernodal loop opens OpenMP threads that fight over the cores, so it runs with
// OpenMP regions inactive and BLAS at one thread; the cores are used one example each.
#include "simulation/sparse_factor.h"

#include <cholmod.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "core/memory_left.h"
#include "simulation/dissection.h"
#include "simulation/large_solver.h"
#include "simulation/one_thread.h"

namespace hookeye {
namespace {

using Long = SuiteSparse_long;

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

}  // namespace

struct SymbolicFactor::Impl {
  std::shared_ptr<const LargeBody> large;  ///< null: there is a factor
  Common common;
  std::vector<int> free, index;  ///< unknown of a free one and back (-1: prescribed)
  std::vector<Long> start, row;  ///< K_ff, upper triangle by columns: CHOLMOD permutes it at once
  std::vector<int> gather;       ///< value of K for each value of the upper triangle
  Eigen::Index nonzeros = 0, columns = 0;
  size_t fingerprint = 0;
  cholmod_factor* factor = nullptr;
  ~Impl() { cholmod_l_free_factor(&factor, &common.c); }

  void take_pattern(const SparseMatrix& K);
  void analyse(const SparseMatrix& K);
  void drop();
  FactorMemory memory() const;
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

void SymbolicFactor::Impl::analyse(const SparseMatrix& K) {
  take_pattern(K);
  const std::vector<std::int64_t> dissected = dissect(K, free, index);
  std::vector<Long> order(dissected.begin(), dissected.end());
  const OneThread serial;
  cholmod_sparse A = view(nullptr);
  factor = cholmod_l_analyze_p(&A, order.data(), nullptr, 0, &common.c);
  common.demand_room(static_cast<double>(2 * sizeof(Long) * row.size()));
  if (!factor) throw std::runtime_error("CHOLMOD cannot analyse the tangent");
}

void SymbolicFactor::Impl::drop() {
  cholmod_l_free_factor(&factor, &common.c);
  start = row = {};
  gather = {};
}

/// Before anything is analysed, which at millions of unknowns takes gigabytes itself: a factor is
/// not wanted, or a block of so many unknowns would not fit. (What is slender takes less. It may be
/// factored if that is asked for.)
static bool is_large(const SymbolicFactor::Impl& s) {
  const SolverChoice when = large_solvers().when;
  if (when != SolverChoice::automatic) return when == SolverChoice::multigrid;
  const double estimate = factor_estimate(static_cast<double>(s.free.size()));
  const double left = memory_left().bytes;
  if (estimate <= left) return false;
  spdlog::debug("{} unknowns by multigrid: a factor needs about {}, and there are {}",
                s.free.size(), memory_text(estimate), memory_text(left));
  return true;
}

SymbolicFactor::SymbolicFactor(const SparseMatrix& K, std::vector<int> free,
                               const Eigen::Matrix2Xi& ends)
    : impl_(std::make_unique<Impl>()) {
  Impl& s = *impl_;
  s.free = std::move(free);
  s.nonzeros = K.nonZeros();
  s.columns = K.cols();
  s.fingerprint = fingerprint_of(K);
  s.index.assign(K.cols(), -1);
  for (size_t i = 0; i < s.free.size(); ++i) s.index[s.free[i]] = static_cast<int>(i);
  if (ends.cols() > 0 && is_large(s)) s.large = std::make_shared<LargeBody>(s.free, ends);
  if (s.large) return;
  s.analyse(K);
  const LargeSolvers& others = large_solvers();
  if (ends.cols() == 0 || others.when != SolverChoice::automatic) return;
  const FactorMemory needed = s.memory();
  const double left = memory_left().bytes;
  if (needed.factor + needed.beside <= left) return;
  spdlog::debug("{} unknowns by multigrid: a factor needs {}, and there are {}", s.free.size(),
                memory_text(needed.factor + needed.beside), memory_text(left));
  s.drop();
  s.large = std::make_shared<LargeBody>(s.free, ends);
}

SymbolicFactor::~SymbolicFactor() = default;
const std::vector<int>& SymbolicFactor::free() const { return impl_->free; }
bool SymbolicFactor::fits(const SparseMatrix& K, const std::vector<int>& free) const {
  return K.cols() == impl_->columns && K.nonZeros() == impl_->nonzeros && free == impl_->free &&
         fingerprint_of(K) == impl_->fingerprint;
}

const std::shared_ptr<const LargeBody>& SymbolicFactor::large() const { return impl_->large; }
FactorMemory SymbolicFactor::memory() const { return impl_->memory(); }

FactorMemory SymbolicFactor::Impl::memory() const {
  if (large)  // half the values of K, once in double and once in float, and an eighth of it below
    return {static_cast<double>(nonzeros) * (6.0 + 1.5), 200.0 * static_cast<double>(free.size())};
  const cholmod_factor& L = *factor;
  const double n = static_cast<double>(free.size()), values = static_cast<double>(row.size());
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
  std::unique_ptr<LargeSolver> large;  ///< null: a factor
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
    : symbolic_(std::move(symbolic)), impl_(std::make_unique<Impl>()) {
  if (symbolic_->large()) impl_->large = large_solvers().make(symbolic_->large());
}
TangentFactor::~TangentFactor() = default;
bool TangentFactor::positive() const { return impl_->positive; }
bool TangentFactor::iterates() const { return impl_->large != nullptr; }

std::shared_ptr<TangentFactor> TangentFactor::another() const {
  auto out = std::make_shared<TangentFactor>(symbolic_);
  if (impl_->large) out->impl_->large = impl_->large->another();
  return out;
}

bool TangentFactor::factorize(const SparseMatrix& K, double shift, const VectorXd& q, bool surely) {
  impl_->positive = false;
  if (impl_->large) {
    impl_->positive = impl_->large->set_up(K, shift, q, surely);
    impl_->count(impl_->large->bytes());
    return impl_->positive;
  }
  SymbolicFactor::Impl& s = symbolic_->impl();
  cholmod_common& c = impl_->common.c;
  if (impl_->factor && !impl_->factor->is_super) impl_->drop();
  const FactorMemory memory = symbolic_->memory();
  const double needed = memory.beside + (impl_->factor ? 0.0 : memory.factor);
  const MemoryClaim claim(needed);
  std::vector<double> values = s.values_of(K, shift);
  const OneThread serial;
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
  if (impl_->large) {
    impl_->positive = false;
    const bool regular = impl_->large->set_up_indefinite(K);
    impl_->count(impl_->large->bytes());
    return regular;
  }
  SymbolicFactor::Impl& s = symbolic_->impl();
  cholmod_common& c = impl_->common.c;
  impl_->drop();
  impl_->positive = false;
  // Values and indices of a factor column by column, with room to grow.
  const double needed =
      1.2 * (sizeof(double) + sizeof(Long)) * s.common.c.lnz + symbolic_->memory().beside;
  const MemoryClaim claim(needed);
  std::vector<double> values = s.values_of(K, 0.0);
  const OneThread serial;
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
  if (impl_->large) {
    impl_->large->solve_exactly(B, X);
    return;
  }
  const OneThread serial;
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
  if (impl_->large) {
    MatrixXd X;
    impl_->large->solve_exactly(b, X);
    x = X;
    return;
  }
  const OneThread serial;
  Impl& w = *impl_;
  solve_block(b.data(), x.data(), b.size(), 1, w.factor, &w.X, &w.Y, &w.E, &w.common.c);
}

bool TangentFactor::solve_within(const VectorXd& b, double tolerance, VectorXd& x) const {
  if (!impl_->large) {
    solve(b, x);
    return true;
  }
  MatrixXd X;
  impl_->positive = impl_->large->solve(b, tolerance, X);
  if (impl_->positive) x = X;
  return impl_->positive;
}

double TangentFactor::factor_nonzeros() const {
  return impl_->factor ? static_cast<double>(impl_->factor->xsize) : 0.0;
}

}  // namespace hookeye
