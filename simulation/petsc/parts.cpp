// The only file that touches PETSc, and MUMPS behind it.
//
// PETSc works in this process alone (MPI_COMM_SELF): load cases are what processes share out. It is
// not made for threads, which therefore wait for one another here. Neither files (.petscrc) nor
// signals are its business, and an error comes back as a number with a text.
#include "simulation/petsc/parts.h"

#include <fmt/format.h>
#include <petscksp.h>

#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <stdexcept>

#include "core/memory_left.h"
#include "simulation/one_thread.h"

namespace hookeye {
namespace {

std::recursive_mutex one_at_a_time;
std::string petsc_says;  ///< of the innermost call that failed

/// PETSc on this thread while it lives.
class Turn {
 public:
  Turn() : lock_(one_at_a_time) {}

 private:
  std::lock_guard<std::recursive_mutex> lock_;
  OneThread serial_;
};

PetscErrorCode keep_message(MPI_Comm, int, const char* function, const char*, PetscErrorCode code,
                            PetscErrorType type, const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL)
    petsc_says = fmt::format("{} ({})", message ? message : "", function ? function : "");
  return code;
}

void ask(PetscErrorCode code) {
  if (code == 0) return;
  if (code == PETSC_ERR_MEM) throw std::bad_alloc();
  throw std::runtime_error(fmt::format("PETSc, error {}: {}", static_cast<int>(code), petsc_says));
}

template <class Object, PetscErrorCode (*Destroy)(Object*)>
class Owned {
 public:
  Owned() = default;
  ~Owned() {
    const Turn turn;
    Destroy(&object_);
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  operator Object() const { return object_; }
  Object* fill() { return &object_; }

 private:
  Object object_ = nullptr;
};
using OwnedMat = Owned<Mat, MatDestroy>;
using OwnedVec = Owned<Vec, VecDestroy>;
using OwnedPc = Owned<PC, PCDestroy>;
using OwnedModes = Owned<MatNullSpace, MatNullSpaceDestroy>;

/// PETSc writes into none of what it is given to read, but says so nowhere.
template <class T>
T* lent(const std::vector<T>& values) {
  return const_cast<T*>(values.data());
}

}  // namespace

PetscSession::PetscSession() {
  const Turn turn;
  int there = 0;
  MPI_Initialized(&there);
  if (there) PETSC_COMM_WORLD = MPI_COMM_SELF;
  // MUMPS's files go where all others go.
  if (const char* folder = std::getenv("TMPDIR")) setenv("MUMPS_OOC_TMPDIR", folder, 0);
  char program[] = "hookeye", no_file[] = "-skip_petscrc", no_signals[] = "-no_signal_handler";
  char* words[] = {program, no_file, no_signals, nullptr};
  int count = 3;
  char** arguments = words;
  ask(PetscInitialize(&count, &arguments, nullptr, nullptr));
  ask(PetscPushErrorHandler(keep_message, nullptr));
}

PetscSession::~PetscSession() {
  const Turn turn;
  PetscPopErrorHandler();
  PetscFinalize();
}

struct AlgebraicMultigrid::Impl {
  OwnedMat K;
  OwnedPc cycle;
  OwnedVec r, z;  ///< without values of their own
};

AlgebraicMultigrid::AlgebraicMultigrid(const CornerBlocks& K, const VectorXd& positions)
    : impl_(std::make_unique<Impl>()) {
  const Turn turn;
  Impl& s = *impl_;
  const PetscInt n = 3 * K.corners();
  ask(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, lent(K.start()), lent(K.column()),
                                lent(K.values()), s.K.fill()));
  ask(MatSetBlockSize(s.K, 3));
  ask(MatSetOption(s.K, MAT_SYMMETRIC, PETSC_TRUE));
  OwnedVec at;
  ask(VecCreateSeqWithArray(PETSC_COMM_SELF, 3, n, positions.data(), at.fill()));
  OwnedModes modes;
  ask(MatNullSpaceCreateRigidBody(at, modes.fill()));
  ask(MatSetNearNullSpace(s.K, modes));
  ask(PCCreate(PETSC_COMM_SELF, s.cycle.fill()));
  ask(PCSetType(s.cycle, PCGAMG));
  ask(PCSetOptionsPrefix(s.cycle, "hookeye_"));
  ask(PCSetFromOptions(s.cycle));
  ask(PCSetOperators(s.cycle, s.K, s.K));
  ask(PCSetUp(s.cycle));
  for (OwnedVec* one : {&s.r, &s.z})
    ask(VecCreateSeqWithArray(PETSC_COMM_SELF, 3, n, nullptr, one->fill()));
}

AlgebraicMultigrid::~AlgebraicMultigrid() = default;

void AlgebraicMultigrid::apply(const double* r, double* z) const {
  const Turn turn;
  ask(VecPlaceArray(impl_->r, r));
  ask(VecPlaceArray(impl_->z, z));
  const PetscErrorCode done = PCApply(impl_->cycle, impl_->r, impl_->z);
  ask(VecResetArray(impl_->r));
  ask(VecResetArray(impl_->z));
  ask(done);
}

namespace {

/// The upper triangle row by row, unknown by unknown: PETSc takes no arrays of larger blocks.
struct UpperRows {
  std::vector<int> start{0}, column;
  std::vector<double> values;

  explicit UpperRows(const NodeBlocks& K) {
    const size_t most = K.values().size();
    demand_memory(static_cast<double>(most) * (sizeof(int) + sizeof(double)));
    column.reserve(most);
    values.reserve(most);
    for (int a = 0; a < K.nodes(); ++a)
      for (int r = 0; r < 3; ++r) {
        for (int k = K.start()[a]; k < K.start()[a + 1]; ++k)
          for (int c = K.column()[k] == a ? r : 0; c < 3; ++c) {
            column.push_back(3 * K.column()[k] + c);
            values.push_back(K.values()[9 * static_cast<size_t>(k) + r + 3 * c]);
          }
        start.push_back(static_cast<int>(column.size()));
      }
  }
};

}  // namespace

struct MumpsFactor::Impl {
  OwnedMat K, factor;
  PetscInt n = 0, negative = 0;
  bool singular = false, on_disk = false;
  double bytes = 0.0;

  double told(int index) const {
    PetscInt value = 0;
    ask(MatMumpsGetInfog(factor, index, &value));
    return static_cast<double>(value);
  }
  void choose_place();
  void take_pivots();
};

/// After the analysis: MUMPS says in millions of bytes what it will take.
void MumpsFactor::Impl::choose_place() {
  bytes = 1e6 * told(16);
  on_disk = bytes > memory_left().bytes;
  if (on_disk) {
    ask(MatMumpsSetIcntl(factor, 22, 1));
    bytes = 1e6 * told(26);
  }
  demand_memory(bytes);
}

void MumpsFactor::Impl::take_pivots() {
  MatFactorError error = MAT_FACTOR_NOERROR;
  ask(MatFactorGetError(factor, &error));
  if (error == MAT_FACTOR_OUTMEMORY) throw OutOfMemory(bytes, memory_left());
  singular = error != MAT_FACTOR_NOERROR || told(28) > 0;
  negative = static_cast<PetscInt>(told(12));
  bytes = 1e6 * told(22);
}

MumpsFactor::MumpsFactor(const NodeBlocks& K) : impl_(std::make_unique<Impl>()) {
  const Turn turn;
  Impl& s = *impl_;
  s.n = 3 * K.nodes();
  const UpperRows upper(K);
  ask(MatCreateSeqSBAIJWithArrays(PETSC_COMM_SELF, 1, s.n, s.n, lent(upper.start),
                                  lent(upper.column), lent(upper.values), s.K.fill()));
  ask(MatGetFactor(s.K, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, s.factor.fill()));
  ask(MatMumpsSetIcntl(s.factor, 24, 1));  // pivots of zero are counted
  ask(MatMumpsSetIcntl(s.factor, 7, 5));   // METIS, as for CHOLMOD
  MatFactorInfo info;
  ask(MatFactorInfoInitialize(&info));
  ask(MatCholeskyFactorSymbolic(s.factor, s.K, nullptr, &info));
  s.choose_place();
  ask(MatCholeskyFactorNumeric(s.factor, s.K, &info));
  s.take_pivots();
  ask(MatDestroy(s.K.fill()));  // before its arrays go
}

MumpsFactor::~MumpsFactor() = default;

int MumpsFactor::negative() const { return impl_->negative; }
bool MumpsFactor::singular() const { return impl_->singular; }
double MumpsFactor::bytes() const { return impl_->bytes; }
bool MumpsFactor::on_disk() const { return impl_->on_disk; }

void MumpsFactor::solve(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) const {
  const Turn turn;
  X.resize(B.rows(), B.cols());
  OwnedMat b, x;
  const auto m = static_cast<PetscInt>(B.cols());
  ask(MatCreateSeqDense(PETSC_COMM_SELF, impl_->n, m, const_cast<double*>(B.data()), b.fill()));
  ask(MatCreateSeqDense(PETSC_COMM_SELF, impl_->n, m, X.data(), x.fill()));
  ask(MatMatSolve(impl_->factor, b, x));
}

}  // namespace hookeye
