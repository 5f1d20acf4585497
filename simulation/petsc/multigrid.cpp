#include "simulation/petsc/multigrid.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <optional>

#include "core/memory_left.h"
#include "simulation/petsc/smoother.h"
#include "simulation/problem.h"

namespace hookeye {
namespace {

/// A solve that leaves more than this of the error with each iteration stagnates: it takes 220 for
/// ten digits, which is as dear as a factor of a block of a million unknowns. The first ones may
/// do less.
constexpr double kSlowest = 0.9;
constexpr int kBeginning = 20;
/// "Exactly": below what differences of solved equilibria can tell.
constexpr double kExactly = 1e-10;
/// Right-hand sides beside each other.
constexpr int kTogether = 4;

enum class Ended { reached, indefinite, stagnates };

int most_iterations(double tolerance) {
  return kBeginning + static_cast<int>(std::ceil(std::log(tolerance) / std::log(kSlowest)));
}

class PetscSolver : public LargeSolver {
 public:
  explicit PetscSolver(std::shared_ptr<const LargeBody> body, bool factored = false)
      : body_(std::move(body)), factored_(factored) {}

  bool set_up(const SparseMatrix& K, double shift, const VectorXd& q, bool surely) override;
  bool set_up_indefinite(const SparseMatrix& K) override;
  bool solve(const MatrixXd& B, double tolerance, MatrixXd& X) override;
  void solve_exactly(const MatrixXd& B, MatrixXd& X) override;
  double bytes() const override;
  std::unique_ptr<LargeSolver> another() const override {
    return std::make_unique<PetscSolver>(body_, factored_);
  }

 private:
  void take(const SparseMatrix& K, double shift);
  bool positive_surely();
  /// By MUMPS from here on. False: singular.
  bool factor();
  void solve_factored(const MatrixXd& B, MatrixXd& X) const;
  template <int M>
  void cycle(const Vectors<M>& r, Vectors<M>& z) const;
  template <int M>
  void below(const Vectors<M>& r, Vectors<M>& z) const;
  template <int M>
  bool bends_down(const Vectors<M>& Z, const Vectors<M>& R) const;
  template <int M>
  Ended gradients(const Vectors<M>& B, double tolerance, Vectors<M>& X) const;
  /// Columns first, first + 1 ... of B.
  template <int M>
  Ended solve_some(const MatrixXd& B, Eigen::Index first, double tolerance, MatrixXd& X) const;

  std::shared_ptr<const LargeBody> body_;
  bool factored_;  ///< iterations have stagnated once
  std::optional<NodeBlocks> K_;
  std::optional<Smoother> smoother_;
  std::optional<CornerBlocks> corners_;
  std::unique_ptr<AlgebraicMultigrid> algebraic_;
  std::unique_ptr<MumpsFactor> mumps_;
};

void PetscSolver::take(const SparseMatrix& K, double shift) {
  mumps_.reset();
  algebraic_.reset();
  if (!K_) {
    K_.emplace(K, body_->free);
    smoother_.emplace(*K_);
  }
  // Of MUMPS the values alone; else what is below the elements, too, about an eighth of K in full.
  const double values = 9.0 * static_cast<double>(K_->column().size());
  if (K_->values().empty())
    demand_memory(values * (factored_ ? sizeof(double) : 1.5 * (sizeof(double) + sizeof(float))));
  K_->take(K, shift);
}

bool PetscSolver::set_up(const SparseMatrix& K, double shift, const VectorXd& q, bool surely) {
  take(K, shift);
  if (factored_) return factor() && mumps_->negative() == 0;
  if (!smoother_->set_up()) return false;
  if (!corners_) corners_.emplace(K, *K_, body_->ends);
  corners_->take(K, shift, *K_);
  VectorXd at(3 * corners_->corners());
  for (int i = 0; i < corners_->corners(); ++i)
    at.segment<3>(3 * i) = q.segment<3>(3 * corners_->node(i));
  algebraic_ = std::make_unique<AlgebraicMultigrid>(*corners_, at);
  return !surely || positive_surely();
}

bool PetscSolver::set_up_indefinite(const SparseMatrix& K) {
  take(K, 0.0);
  return factor();
}

bool PetscSolver::factor() {
  algebraic_.reset();
  mumps_ = std::make_unique<MumpsFactor>(*K_);
  spdlog::debug("{} unknowns factored by MUMPS{}: {}", body_->free.size(),
                mumps_->on_disk() ? " on disk" : "", memory_text(mumps_->bytes()));
  return !mumps_->singular();
}

/// With an eigenvector of M^-1 K whose eigenvalue is negative, and a part c of it in the right-hand
/// side, no residual is smaller than c: the polynomials of conjugate gradients are 1 at zero, and
/// larger than 1 below it for as long as their roots, Ritz values, are positive. So iterations to
/// less than c pass a negative curvature. Of noise c has a normal distribution around the size of
/// all over the root of their number: a thousandth of that is missed once in a thousand times.
bool PetscSolver::positive_surely() {
  VectorXd b(static_cast<Eigen::Index>(body_->free.size()));
  std::uint64_t state = 0x2545f4914f6cdd1dULL;
  for (double& value : b) {  // xorshift64
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    value = static_cast<double>(state >> 11) / 4503599627370496.0 - 1.0;
  }
  MatrixXd X;
  const double tolerance = 1e-3 / std::sqrt(static_cast<double>(b.size()));
  return solve(b, tolerance, X);
}

/// All columns, one after the other: PETSc has one vector.
template <int M>
void PetscSolver::below(const Vectors<M>& r, Vectors<M>& z) const {
  z.resize(M, r.cols());
  VectorXd one, there(r.cols());
  for (int m = 0; m < M; ++m) {
    one = r.row(m).transpose();
    algebraic_->apply(one.data(), there.data());
    z.row(m) = there.transpose();
  }
}

template <int M>
void PetscSolver::cycle(const Vectors<M>& r, Vectors<M>& z) const {
  if (corners_->all()) {
    below<M>(r, z);
    return;
  }
  Vectors<M> rest = r, coarse, up = Vectors<M>::Zero(M, r.cols());
  smoother_->smooth<M>(rest, z);
  below<M>(corners_->restricted<M>(*K_, rest), coarse);
  corners_->add_prolonged<M>(*K_, std::move(coarse), up);
  z += up;
  smoother_->take_off<M>(up, rest);
  smoother_->smooth_again<M>(rest, z);
}

/// Where the cycle is indefinite K may be, or the cycle is at fault: a curvature of K that is
/// negative tells, along the cycle's answer Z to the residual R or what the corners have of it.
template <int M>
bool PetscSolver::bends_down(const Vectors<M>& Z, const Vectors<M>& R) const {
  Vectors<M> coarse, along = Z, K_along;
  for (int part = 0; part < 2; ++part) {
    K_->multiply<double, M>(K_->values(), along, K_along);
    if ((along.cwiseProduct(K_along).rowwise().sum().array() < 0).any()) return true;
    if (corners_->all()) return false;
    below<M>(corners_->restricted<M>(*K_, R), coarse);
    along.setZero();
    corners_->add_prolonged<M>(*K_, coarse, along);
  }
  return false;
}

/// Each column with coefficients of its own.
template <int M>
Ended PetscSolver::gradients(const Vectors<M>& B, double tolerance, Vectors<M>& X) const {
  using Each = Eigen::Array<double, M, 1>;
  const auto dot = [](const Vectors<M>& a, const Vectors<M>& b) -> Each {
    return a.cwiseProduct(b).rowwise().sum().array();
  };
  Vectors<M> R = B, Z, P, KP;
  X.setZero(M, B.cols());
  cycle<M>(R, Z);
  P = Z;
  Each rz = dot(R, Z);
  const Each goal = tolerance * tolerance * rz;
  const int most = most_iterations(tolerance);
  for (int i = 1; i <= most; ++i) {
    if (!rz.allFinite()) return Ended::stagnates;
    if ((rz < 0).any()) return bends_down<M>(Z, R) ? Ended::indefinite : Ended::stagnates;
    if ((rz <= goal).all()) {
      spdlog::debug("multigrid: {} iterations to {:.0e}", i - 1, tolerance);
      return Ended::reached;
    }
    K_->multiply<double, M>(K_->values(), P, KP);
    const Each curvature = dot(P, KP);
    const auto going = rz > goal;
    if ((going && !(curvature > 0)).any()) return Ended::indefinite;
    const Each alpha = going.select(rz / curvature, 0.0);
    X += alpha.matrix().asDiagonal() * P;
    R -= alpha.matrix().asDiagonal() * KP;
    cycle<M>(R, Z);
    const Each next = dot(R, Z);
    const Each beta = going.select(next / rz, 0.0);
    P = Z + beta.matrix().asDiagonal() * P;
    rz = going.select(next, rz);
  }
  return Ended::stagnates;
}

template <int M>
Ended PetscSolver::solve_some(const MatrixXd& B, Eigen::Index first, double tolerance,
                              MatrixXd& X) const {
  Vectors<M> b = Vectors<M>::Zero(M, 3 * K_->nodes()), x;
  for (size_t i = 0; i < body_->free.size(); ++i)
    b.col(body_->free[i]) = B.row(static_cast<Eigen::Index>(i)).segment<M>(first).transpose();
  const Ended ended = gradients<M>(b, tolerance, x);
  if (ended == Ended::reached)
    for (size_t i = 0; i < body_->free.size(); ++i)
      X.row(static_cast<Eigen::Index>(i)).segment<M>(first) = x.col(body_->free[i]).transpose();
  return ended;
}

bool PetscSolver::solve(const MatrixXd& B, double tolerance, MatrixXd& X) {
  if (B.rows() == 0 || B.cols() == 0) {
    X.resize(B.rows(), B.cols());
    return true;
  }
  X.resize(B.rows(), B.cols());
  for (Eigen::Index first = 0; first < B.cols() && !mumps_;) {
    const bool together = B.cols() - first >= kTogether;
    const Ended ended = together ? solve_some<kTogether>(B, first, tolerance, X)
                                 : solve_some<1>(B, first, tolerance, X);
    if (ended == Ended::indefinite) return false;
    if (ended == Ended::stagnates) {
      if (!factor()) return false;
      factored_ = mumps_->negative() == 0;  // else it was not the law
      if (factored_)
        spdlog::info(
            "multigrid stagnates on {} unknowns (a nearly incompressible law?): MUMPS factors them",
            body_->free.size());
      break;
    }
    first += together ? kTogether : 1;
  }
  if (!mumps_) return true;
  if (mumps_->negative() > 0) return false;
  solve_factored(B, X);
  return true;
}

void PetscSolver::solve_exactly(const MatrixXd& B, MatrixXd& X) {
  if (solve(B, kExactly, X)) return;
  if (!mumps_) factor();
  solve_factored(B, X);
}

void PetscSolver::solve_factored(const MatrixXd& B, MatrixXd& X) const {
  MatrixXd b = MatrixXd::Zero(3 * K_->nodes(), B.cols()), x;
  b(body_->free, Eigen::all) = B;
  mumps_->solve(b, x);
  X = x(body_->free, Eigen::all);
}

double PetscSolver::bytes() const {
  return (K_ ? K_->bytes() + smoother_->bytes() : 0.0) + (corners_ ? corners_->bytes() : 0.0) +
         (mumps_ ? mumps_->bytes() : 0.0);
}

}  // namespace

std::unique_ptr<LargeSolver> petsc_solver(std::shared_ptr<const LargeBody> body) {
  return std::make_unique<PetscSolver>(std::move(body));
}

}  // namespace hookeye
