#include "simulation/problem.h"

#include "simulation/of_mesh.h"

namespace hookeye {

bool Problem::has_potential() const {
  for (const auto& f : loading.forces)
    if (!f->has_potential()) return false;
  return true;
}

double Problem::potential(const VectorXd& q, double s) const {
  double sum = assembly.energy(energy, q);
  for (const auto& f : loading.forces) sum += f->potential(mesh, q, load(s));
  if (held_by) sum -= (1.0 - s) * held_by->dot(q);
  return sum;
}

VectorXd Problem::residual(const VectorXd& q, double s) const {
  VectorXd R = VectorXd::Zero(q.size());
  assembly.add_forces(energy, q, R);
  for (const auto& f : loading.forces) f->add_residual(mesh, q, load(s), R);
  if (held_by) R -= (1.0 - s) * *held_by;
  return R;
}

VectorXd Problem::external(const VectorXd& q, double s) const {
  VectorXd R = VectorXd::Zero(q.size());
  for (const auto& f : loading.forces) f->add_residual(mesh, q, load(s), R);
  return -R;
}

void Problem::tangent(const VectorXd& q, double s, bool projected, SparseMatrix& K) const {
  assembly.set_tangent(energy, q, projected, K);
  Triplets triplets;
  for (const auto& f : loading.forces)
    if (!f->dead()) f->add_tangent(mesh, q, load(s), triplets);
  if (!triplets.empty()) add_triplets(triplets, K);
}

SparseMatrix Problem::skew_tangent(const VectorXd& q, double s) const {
  Triplets triplets;
  for (const auto& f : loading.forces) f->add_skew_tangent(mesh, q, load(s), triplets);
  double largest = 0;
  for (const auto& t : triplets) largest = std::max(largest, std::abs(t.value()));
  if (largest == 0) return {};
  SparseMatrix W(q.size(), q.size());
  W.setFromTriplets(triplets.begin(), triplets.end());
  W.prune(largest, 1e-12);  // neighbouring faces cancel but for rounding
  return W;
}

std::vector<int> Problem::free_unknowns() const {
  std::vector<int> free;
  free.reserve(3 * mesh.nodes() - loading.prescribed.size());
  auto next = loading.prescribed.begin();
  for (int u = 0; u < 3 * mesh.nodes(); ++u) {
    if (next != loading.prescribed.end() && *next == u)
      ++next;
    else
      free.push_back(u);
  }
  return free;
}

void add_triplets(const Triplets& triplets, SparseMatrix& K) {
  Triplets outside;
  for (const auto& t : triplets) {
    const int* first = K.innerIndexPtr() + K.outerIndexPtr()[t.col()];
    const int* last = K.innerIndexPtr() + K.outerIndexPtr()[t.col() + 1];
    const int* at = std::lower_bound(first, last, t.row());
    if (at != last && *at == t.row())
      K.valuePtr()[at - K.innerIndexPtr()] += t.value();
    else
      outside.push_back(t);
  }
  if (outside.empty()) return;
  SparseMatrix more(K.rows(), K.cols());
  more.setFromTriplets(outside.begin(), outside.end());
  K = SparseMatrix(K + more);
}

SparseMatrix sum(const SparseMatrix& K, const SparseMatrix& W) {
  SparseMatrix all = K;
  for (Eigen::Index column = 0; column < W.outerSize(); ++column)
    for (SparseMatrix::InnerIterator it(W, column); it; ++it)
      all.coeffRef(it.row(), column) += it.value();
  return all;
}

SparseMatrix free_block(const SparseMatrix& W, const std::vector<int>& free) {
  const auto size = static_cast<Eigen::Index>(free.size());
  SparseMatrix block(size, size);
  if (W.nonZeros() == 0) return block;
  const auto index = [&](Eigen::Index unknown) {
    const auto at = std::lower_bound(free.begin(), free.end(), unknown);
    return at != free.end() && *at == unknown ? static_cast<int>(at - free.begin()) : -1;
  };
  Triplets inside;
  for (Eigen::Index column = 0; column < W.outerSize(); ++column)
    for (SparseMatrix::InnerIterator it(W, column); it; ++it)
      if (const int i = index(it.row()), j = index(column); i >= 0 && j >= 0)
        inside.emplace_back(i, j, it.value());
  block.setFromTriplets(inside.begin(), inside.end());
  return block;
}

VectorXd select(const VectorXd& all, const std::vector<int>& unknowns) {
  VectorXd some(static_cast<Eigen::Index>(unknowns.size()));
  for (size_t i = 0; i < unknowns.size(); ++i)
    some[static_cast<Eigen::Index>(i)] = all[unknowns[i]];
  return some;
}

VectorXd spread(const VectorXd& some, const std::vector<int>& unknowns, Eigen::Index size) {
  VectorXd all = VectorXd::Zero(size);
  for (size_t i = 0; i < unknowns.size(); ++i)
    all[unknowns[i]] = some[static_cast<Eigen::Index>(i)];
  return all;
}

double internal_energy(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q) {
  return assembly_of(mesh)->energy(energy, q);
}

VectorXd residual(const TetMesh& mesh, const EnergyModel& energy, const Loading& loading,
                  const VectorXd& q, double load_fraction) {
  const auto assembly = assembly_of(mesh);
  return Problem{mesh, *assembly, energy, loading}.residual(q, load_fraction);
}

SparseMatrix tangent(const TetMesh& mesh, const EnergyModel& energy, const Loading& loading,
                     const VectorXd& q, double load_fraction) {
  const auto assembly = assembly_of(mesh);
  const Problem problem{mesh, *assembly, energy, loading};
  SparseMatrix K;
  problem.tangent(q, load_fraction, false, K);
  return sum(K, problem.skew_tangent(q, load_fraction));
}

MatrixXd element_forces(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q) {
  return assembly_of(mesh)->element_forces(energy, q);
}

VectorXd dR_dtheta(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q, int part,
                   int k) {
  return assembly_of(mesh)->dR_dtheta(energy, q, part, k);
}

Eigen::MatrixXd all_dR_dtheta(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q,
                              int part) {
  return assembly_of(mesh)->all_dR_dtheta(energy, q, part);
}

}  // namespace hookeye
