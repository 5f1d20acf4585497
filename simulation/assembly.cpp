#include "simulation/assembly.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <utility>

#include "core/input_error.h"
#include "core/memory_left.h"
#include "simulation/energy_parts.h"
#include "simulation/quadrature.h"

namespace hookeye {
namespace {

double swelling_of(const EnergyModel& model, int e) {
  return model.swelling.size() ? model.swelling[e] : 1.0;
}

/// Points that one call of a BatchTerm is asked for: their tangents take 5 MB.
constexpr int kPointsTogether = 8192;

/// Negative eigenvalues turned positive: a descent direction that keeps the curvature's size.
void project(Matrix9d& D) {
  const Eigen::SelfAdjointEigenSolver<Matrix9d> eigen(D);
  if (eigen.eigenvalues()[0] >= 0) return;
  D = eigen.eigenvectors() * eigen.eigenvalues().cwiseAbs().asDiagonal() *
      eigen.eigenvectors().transpose();
}

}  // namespace

/// Loops with the number of nodes of an element known at compile time.
template <int N>
struct Assembly::Kernel {
  using Gradient = Eigen::Map<const Eigen::Matrix<double, N, 3>>;
  using Nodes = Eigen::Matrix<double, 3, N>;
  const Assembly& a;

  Gradient gradient(int e, int point) const {
    const size_t index = static_cast<size_t>(e) * (a.points_ + a.corners_) + point;
    return Gradient(a.gradients_.data() + index * 3 * N);
  }
  Nodes gather(const VectorXd& q, int e) const {
    Nodes x;
    for (int i = 0; i < N; ++i) x.col(i) = q.segment<3>(3 * a.nodes_(i, e));
    return x;
  }

  /// Calls `each` with the first and the last element (not in it) of blocks: of all, where no
  /// part is asked for many points.
  template <class Each>
  void by_blocks(const EnergyParts& parts, Each&& each) const {
    const int all = a.elements();
    const int block = parts.together.empty() ? all : std::max(1, kPointsTogether / a.points_);
    for (int first = 0; first < all; first += block) each(first, std::min(first + block, all));
  }

  /// What the parts that are asked for many points add at those of a block, a column each (element
  /// by element): `ask` of the term times weight times g^`power`. Without columns: there are none.
  template <int Rows, class Ask>
  Eigen::Matrix<double, Rows, Eigen::Dynamic> together(const EnergyParts& parts, const VectorXd& q,
                                                       int first, int last, int power,
                                                       Ask&& ask) const {
    Eigen::Matrix<double, Rows, Eigen::Dynamic> sum;
    if (parts.together.empty()) return sum;
    Matrix9Xd F(9, (last - first) * a.points_);
    for (int e = first, k = 0; e < last; ++e) {
      const Nodes x = gather(q, e);
      for (int p = 0; p < a.points_; ++p, ++k)
        F.col(k) = ((x * gradient(e, p)) / parts.swelling(e)).eval().reshaped();
    }
    sum.setZero(Rows, F.cols());
    for (const auto& [part, term] : parts.together) {
      const auto values = ask(*term, F);
      for (int e = first, k = 0; e < last; ++e) {
        const double w = EnergyParts::weight(*part, e) * std::pow(parts.swelling(e), power);
        for (int p = 0; p < a.points_; ++p, ++k)
          if (w != 0) sum.col(k) += w * values.col(k);
      }
    }
    return sum;
  }

  double energy(const EnergyModel& model, const VectorXd& q) const {
    const EnergyParts parts(model);
    double sum = 0;
    by_blocks(parts, [&](int first, int last) {
      const auto more = together<1>(parts, q, first, last, 3,
                                    [](const BatchTerm& t, const auto& F) { return t.psi_of(F); });
      for (int e = first, k = 0; e < last; ++e) {
        const Nodes x = gather(q, e);
        for (int p = 0; p < a.points_; ++p, ++k) {
          double psi = parts.psi(e, x * gradient(e, p));
          if (more.cols() > 0) psi += more[k];
          sum += a.volume(e, p) * psi;
        }
      }
    });
    return sum;
  }

  /// Calls `each` with every element and its internal forces.
  template <class Each>
  void forces(const EnergyModel& model, const VectorXd& q, Each&& each) const {
    const EnergyParts parts(model);
    by_blocks(parts, [&](int first, int last) {
      const auto more = together<9>(parts, q, first, last, 2,
                                    [](const BatchTerm& t, const auto& F) { return t.P_of(F); });
      for (int e = first; e < last; ++e)
        each(e, force(q, e, [&](const Matrix3d& F, int p) -> Matrix3d {
               if (more.cols() == 0) return parts.P(e, F);
               return parts.P(e, F) + more.col((e - first) * a.points_ + p).reshaped(3, 3);
             }));
    });
  }

  template <class Stress>
  Nodes force(const VectorXd& q, int e, Stress&& stress_at) const {
    const Nodes x = gather(q, e);
    Nodes f = Nodes::Zero();
    for (int p = 0; p < a.points_; ++p) {
      const auto G = gradient(e, p);
      const Matrix3d P = a.volume(e, p) * stress_at(x * G, p);
      f.noalias() += P * G.transpose();
    }
    return f;
  }
  void scatter(const Nodes& f, int e, VectorXd& R) const {
    for (int i = 0; i < N; ++i) R.segment<3>(3 * a.nodes_(i, e)) += f.col(i);
  }

  /// K_ab += sum_AB g_aA D_AB g_bB over the 3x3 blocks of D; blocks b <= a only.
  void add_stiffness(const Matrix9d& D, const Gradient& G,
                     Eigen::Matrix<double, 3 * N, 3 * N>& K) const {
    Eigen::Matrix<double, 9, 3 * N> T;
    for (int b = 0; b < N; ++b)
      T.template middleCols<3>(3 * b).noalias() = G(b, 0) * D.template leftCols<3>() +
                                                  G(b, 1) * D.template middleCols<3>(3) +
                                                  G(b, 2) * D.template rightCols<3>();
    for (int j = 0; j < 3 * N; ++j) {
      const Matrix3d t = Eigen::Map<const Matrix3d>(T.data() + 9 * j);
      for (int b = j / 3; b < N; ++b)
        K.template block<3, 1>(3 * b, j) +=
            t.col(0) * G(b, 0) + t.col(1) * G(b, 1) + t.col(2) * G(b, 2);
    }
  }

  void tangent(const EnergyModel& model, const VectorXd& q, bool projected, double* values) const {
    const EnergyParts parts(model);
    Eigen::Matrix<double, 3 * N, 3 * N> K;
    by_blocks(parts, [&](int first, int last) {
      const auto more =
          together<81>(parts, q, first, last, 1,
                       [](const BatchTerm& t, const auto& F) { return t.dP_dF_of(F); });
      for (int e = first, k = 0; e < last; ++e) {
        const Nodes x = gather(q, e);
        K.setZero();
        for (int p = 0; p < a.points_; ++p, ++k) {
          const auto G = gradient(e, p);
          Matrix9d D = parts.dP_dF(e, x * G);
          if (more.cols() > 0) D += more.col(k).reshaped(9, 9);
          if (projected) project(D);
          D *= a.volume(e, p);
          add_stiffness(D, G, K);
        }
        scatter_tangent(K, e, values);
      }
    });
  }
  void scatter_tangent(const Eigen::Matrix<double, 3 * N, 3 * N>& K, int e, double* values) const {
    const int* block = a.block_.data() + static_cast<size_t>(e) * N * N;
    for (int b = 0; b < N; ++b)
      for (int i = 0; i < N; ++i) {
        double* v = values + block[i + N * b];
        const int stride = a.column_size(a.nodes_(b, e));
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r)  // lower triangle of blocks holds K, the upper its mirror
            v[c * stride + r] += i >= b ? K(3 * i + r, 3 * b + c) : K(3 * b + c, 3 * i + r);
      }
  }

  double smallest_J(const VectorXd& q, int* element) const {
    double least = std::numeric_limits<double>::infinity();
    for (int e = 0; e < a.elements(); ++e) {
      const Nodes x = gather(q, e);
      for (int p = 0; p < a.points_ + a.corners_; ++p) {
        const Matrix3d F = x * gradient(e, p);
        const double J = F.determinant();
        if (J < least || !std::isfinite(J)) {
          least = std::isfinite(J) ? J : -std::numeric_limits<double>::infinity();
          if (element) *element = e;
          if (!std::isfinite(J)) return least;
        }
      }
    }
    return least;
  }
};

template <class Function>
auto Assembly::dispatch(Function&& f) const {
  return npe_ == 4 ? f(Kernel<4>{*this}) : f(Kernel<10>{*this});
}

Assembly::Assembly(const TetMesh& mesh)
    : npe_(mesh.nodes_per_element()), n_(mesh.nodes()), nodes_(mesh.elements) {
  const TetRule& rule = stiffness_rule(mesh.order);
  points_ = static_cast<int>(rule.points.size());
  corners_ = mesh.order == 1 ? 0 : 4;
  const size_t gradients = static_cast<size_t>(elements()) * (points_ + corners_) * npe_ * 3;
  demand_memory(static_cast<double>(gradients) * sizeof(double));
  gradients_.resize(gradients);
  volume_.resize(static_cast<size_t>(elements()) * points_);
  dispatch([&]<int N>(Kernel<N>) {
    using Gradients = Eigen::Matrix<double, N, 3>;
    std::vector<Gradients> dN;
    for (const auto& p : rule.points) dN.push_back(shape_derivatives(mesh.order, p));
    for (int c = 0; c < corners_; ++c)
      dN.push_back(shape_derivatives(mesh.order, Eigen::Vector4d::Unit(c)));
    double* out = gradients_.data();
    Eigen::Matrix<double, 3, N> x;
    for (int e = 0; e < elements(); ++e) {
      for (int i = 0; i < N; ++i) x.col(i) = mesh.X.col(nodes_(i, e));
      for (size_t p = 0; p < dN.size(); ++p, out += 3 * N) {
        const Matrix3d jacobian = x * dN[p];
        Eigen::Map<Gradients>(out).noalias() = dN[p] * jacobian.inverse();
        if (static_cast<int>(p) < points_)
          volume_[e * points_ + p] = rule.weights[p] * jacobian.determinant() / 6.0;
      }
    }
    return 0;
  });
}

double Assembly::energy(const EnergyModel& model, const VectorXd& q) const {
  return dispatch([&](auto kernel) { return kernel.energy(model, q); });
}

void Assembly::add_forces(const EnergyModel& model, const VectorXd& q, VectorXd& R) const {
  if (model.parts.empty()) return;  // forces alone are asked for (effects, linear in a load)
  dispatch([&](auto kernel) {
    kernel.forces(model, q, [&](int e, const auto& f) { kernel.scatter(f, e, R); });
    return 0;
  });
}

MatrixXd Assembly::element_forces(const EnergyModel& model, const VectorXd& q) const {
  MatrixXd all(3 * npe_, elements());
  dispatch([&](auto kernel) {
    kernel.forces(model, q, [&](int e, const auto& f) { all.col(e) = f.reshaped(); });
    return 0;
  });
  return all;
}

VectorXd Assembly::dR_dtheta(const EnergyModel& model, const VectorXd& q, int part, int k) const {
  VectorXd R = VectorXd::Zero(3 * n_);
  const auto& chosen = model.parts[part];
  dispatch([&](auto kernel) {
    for (int e = 0; e < elements(); ++e) {
      const double g = swelling_of(model, e), w = EnergyParts::weight(chosen, e) * g * g;
      if (w == 0) continue;
      kernel.scatter(kernel.force(q, e,
                                  [&](const Matrix3d& F, int) -> Matrix3d {
                                    return w * chosen.dP_dtheta(e, F / g, k);
                                  }),
                     e, R);
    }
    return 0;
  });
  return R;
}

MatrixXd Assembly::all_dR_dtheta(const EnergyModel& model, const VectorXd& q, int part) const {
  const auto& chosen = model.parts[part];
  MatrixXd R = MatrixXd::Zero(3 * n_, chosen.term->size());
  dispatch([&](auto kernel) {
    for (int e = 0; e < elements(); ++e) {
      const double g = swelling_of(model, e), w = EnergyParts::weight(chosen, e) * g * g;
      if (w == 0) continue;
      const auto x = kernel.gather(q, e);
      for (int p = 0; p < points_; ++p) {
        const auto G = kernel.gradient(e, p);
        const auto dP = chosen.all_dP_dtheta(e, x * G / g);
        for (Eigen::Index k = 0; k < dP.cols(); ++k) {
          if (dP.col(k).isZero(0.0)) continue;
          const Matrix3d P = (w * volume(e, p)) * dP.col(k).reshaped(3, 3);
          for (int i = 0; i < npe_; ++i)
            R.col(k).segment<3>(3 * nodes_(i, e)) += P * G.row(i).transpose();
        }
      }
    }
    return 0;
  });
  return R;
}

void Assembly::find_neighbours() {
  std::vector<int> first(n_ + 1, 0), around(static_cast<size_t>(nodes_.size()));  // elements
  for (const int a : nodes_.reshaped()) ++first[a + 1];
  for (int a = 0; a < n_; ++a) first[a + 1] += first[a];
  std::vector<int> next(first.begin(), first.end() - 1), seen(n_, -1);
  for (int e = 0; e < elements(); ++e)
    for (const int a : nodes_.col(e)) around[next[a]++] = e;
  first_near_.assign(1, 0);
  first_near_.reserve(n_ + 1);
  for (int a = 0; a < n_; ++a) {
    for (int k = first[a]; k < first[a + 1]; ++k)
      for (const int b : nodes_.col(around[k]))
        if (std::exchange(seen[b], a) != a) near_.push_back(b);
    std::sort(near_.begin() + first_near_.back(), near_.end());
    if (near_.size() > std::numeric_limits<int>::max() / 9)
      throw InputError({},
                       fmt::format("{} unknowns: their tangent has more than 2^31 values", 3 * n_),
                       "a coarser mesh (`edge`)");
    first_near_.push_back(static_cast<int>(near_.size()));
  }
}

void Assembly::find_pattern() {
  if (!first_near_.empty()) return;
  demand_memory(static_cast<double>(nodes_.size()) * npe_ * 2 * sizeof(int));
  find_neighbours();
  block_.resize(static_cast<size_t>(elements()) * npe_ * npe_);
  for (int e = 0; e < elements(); ++e)
    for (int b = 0; b < npe_; ++b) {
      const int node = nodes_(b, e);
      const auto begin = near_.begin() + first_near_[node];
      const auto end = near_.begin() + first_near_[node + 1];
      for (int i = 0; i < npe_; ++i)
        block_[(static_cast<size_t>(e) * npe_ + b) * npe_ + i] =
            9 * first_near_[node] +
            3 * static_cast<int>(std::lower_bound(begin, end, nodes_(i, e)) - begin);
    }
}

SparseMatrix Assembly::zero_tangent() {
  find_pattern();
  const auto values = 9 * static_cast<Eigen::Index>(near_.size());
  demand_memory(static_cast<double>(values) * (sizeof(double) + sizeof(int)));
  SparseMatrix K(3 * n_, 3 * n_);
  K.resizeNonZeros(values);
  int next = 0, column = 0;
  for (int a = 0; a < n_; ++a)
    for (int c = 0; c < 3; ++c) {
      K.outerIndexPtr()[column++] = next;
      for (int k = first_near_[a]; k < first_near_[a + 1]; ++k)
        for (int r = 0; r < 3; ++r) K.innerIndexPtr()[next++] = 3 * near_[k] + r;
    }
  K.outerIndexPtr()[column] = next;
  std::fill_n(K.valuePtr(), next, 0.0);
  return K;
}

void Assembly::set_tangent(const EnergyModel& model, const VectorXd& q, bool projected,
                           SparseMatrix& K) {
  find_pattern();
  if (K.nonZeros() != 9 * static_cast<Eigen::Index>(near_.size()) || K.cols() != 3 * n_) {
    K = {};  // before there is another
    K = zero_tangent();
  }
  std::fill_n(K.valuePtr(), K.nonZeros(), 0.0);
  dispatch([&](auto kernel) {
    kernel.tangent(model, q, projected, K.valuePtr());
    return 0;
  });
}

double Assembly::smallest_J(const VectorXd& q, int* element) const {
  return dispatch([&](auto kernel) { return kernel.smallest_J(q, element); });
}

}  // namespace hookeye
