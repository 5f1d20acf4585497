#include "simulation/laws/strain_components.h"

#include <cmath>

namespace hookeye::laws {
namespace {

using Kind = StrainComponent::Kind;

/// Axes of a component of the Green strain.
std::pair<int, int> axes(Kind kind) {
  switch (kind) {
    case Kind::e11:
      return {0, 0};
    case Kind::e22:
      return {1, 1};
    case Kind::e33:
      return {2, 2};
    case Kind::e12:
      return {0, 1};
    case Kind::e13:
      return {0, 2};
    default:
      return {1, 2};
  }
}

/// D += s kron(a b^T symmetrised, 1): what a component of E adds through S.
void add_geometric(double s, int a, int b, Matrix9d& D) {
  const double half = a == b ? s : 0.5 * s;
  for (int i = 0; i < 3; ++i) {
    D(3 * a + i, 3 * b + i) += half;
    if (a != b) D(3 * b + i, 3 * a + i) += half;
  }
}

/// I1bar - 3 without the cancellation of tr C - 3 near rest: I1 - 3 = 2 tr E and J^(-2/3) - 1.
double isochoric_strain(const Matrix3d& F, double J) {
  const double trace2 = F.squaredNorm() - 3.0;  // 2 tr E
  const double s = std::expm1(-2.0 / 3.0 * std::log(J));
  return std::max(0.0, trace2 + s * (trace2 + 3.0));
}

}  // namespace

ComponentValues::ComponentValues(const AdditiveModel& model, const Matrix3d& F, bool gradients)
    : model_(model), d_(F) {
  const int m = static_cast<int>(model.components.size());
  if (gradients) g_.setZero(9, m);
  for (int c = 0; c < m; ++c) {
    const StrainComponent& component = model.components[c];
    switch (component.kind) {
      case Kind::trace:
        e_[c] = 0.5 * (F.squaredNorm() - 3.0);
        break;
      case Kind::i1bar:
        e_[c] = d_.J > 0 ? std::sqrt(isochoric_strain(F, d_.J)) : 0.0;
        break;
      case Kind::volume:
        e_[c] = d_.J - 1.0;
        break;
      case Kind::fibre:
        e_[c] = (F * (model.frame.transpose() * component.direction)).norm() - 1.0;
        break;
      default: {
        const auto [a, b] = axes(component.kind);
        e_[c] = 0.5 * (F.col(a).dot(F.col(b)) - (a == b ? 1.0 : 0.0));
      }
    }
    if (gradients) set_gradient(c, component);
  }
}

void ComponentValues::set_gradient(int c, const StrainComponent& component) {
  const Matrix3d& F = d_.F;
  switch (component.kind) {
    case Kind::trace:
      g_.col(c) = vec(F);
      break;
    case Kind::i1bar:
      g_.col(c) = vec(i1bar(d_).gradient(d_));
      break;
    case Kind::volume:
      g_.col(c) = vec(d_.cof);
      break;
    case Kind::fibre: {
      const Eigen::Vector3d a = model_.frame.transpose() * component.direction;
      g_.col(c) = vec(F * a * a.transpose()) / (1.0 + e_[c]);
      break;
    }
    default: {
      const auto [a, b] = axes(component.kind);
      g_.col(c).segment<3>(3 * a) += 0.5 * F.col(b);
      g_.col(c).segment<3>(3 * b) += 0.5 * F.col(a);
    }
  }
}

ComponentValues::Root ComponentValues::root(double d1, double d2, double g) const {
  // Below 1e-6 the square of g is rounding: Psi' = Psi''(0) g there.
  if (g < 1e-6) return {d2, 0.0};
  const double first = d1 / g;
  return {first, (d2 - first) / (g * g)};
}

Vector9d ComponentValues::gradient(int c) const {
  if (model_.components[c].kind != Kind::i1bar) return g_.col(c);
  if (e_[c] < 1e-6) return Vector9d::Zero();
  return g_.col(c) / (2.0 * e_[c]);
}

Matrix3d ComponentValues::stress(const Strains& d1) const {
  Vector9d P = Vector9d::Zero();
  for (int c = 0; c < g_.cols(); ++c) P += d1[c] * gradient(c);
  return unvec(P);
}

void ComponentValues::add_isochoric(const StrainEnergy& energy, int c, Matrix9d& D) const {
  // By x = g^2 = I1bar - 3: dPsi/dx = (Psi'/g)/2, d2Psi/dx2 = (Psi'' - Psi'/g)/(4 g^2).
  const Root r = root(energy.d1[c], energy.d2[c][c], e_[c]);
  const Isochoric i = i1bar(d_);
  const double d2J = i.add_hessian(d_, 0.5 * r.first, 0.25 * r.second, D);
  add_d2I1(0.5 * r.first * i.scale, D);
  add_d2J(d2J, d_.F, D);
}

Matrix9d ComponentValues::stiffness(const StrainEnergy& energy) const {
  const int m = static_cast<int>(g_.cols());
  Matrix9d D = Matrix9d::Zero();
  double d2J = 0.0;
  for (int c = 0; c < m; ++c) {
    const StrainComponent& component = model_.components[c];
    if (component.kind == Kind::i1bar) {
      add_isochoric(energy, c, D);
      continue;
    }
    // sum_d d2_cd g_d, then the outer product with g_c: the symmetric second-order part.
    Vector9d row = Vector9d::Zero();
    bool any = false;
    for (int d = 0; d < m; ++d)
      if (energy.d2[c][d] != 0.0) row += energy.d2[c][d] * g_.col(d), any = true;
    if (any)
      for (int j = 0; j < 9; ++j)
        if (g_(j, c) != 0.0) D.col(j) += g_(j, c) * row;
    const double d1 = energy.d1[c];
    switch (component.kind) {
      case Kind::trace:
        D.diagonal().array() += d1;
        break;
      case Kind::volume:
        d2J += d1;
        break;
      case Kind::fibre: {
        const Eigen::Vector3d a = model_.frame.transpose() * component.direction;
        const double stretch = 1.0 + e_[c];
        add_d2I4(0.5 * d1 / stretch, a, D);
        D -= (d1 / stretch) * g_.col(c) * g_.col(c).transpose();
        break;
      }
      default: {
        const auto [a, b] = axes(component.kind);
        add_geometric(d1, a, b, D);
      }
    }
  }
  if (d2J != 0.0) add_d2J(d2J, d_.F, D);
  return D;
}

}  // namespace hookeye::laws
