// additive {frame, E11: {at, stiffness}, E11_E22: {at, at_2, stiffness}, J: ..., barrier: ...}
//
// W = sum of addends, each an interpolated function of one or two strain components in a material
// frame (simulation/additive.h; Miguel, Miraut, Otaduy 2016). For materials that no textbook law
// fits: different functions along the axes, other stiffness in tension than in compression, walls.
// Control values are tangent moduli at the control points, so that forces are linear in them and a
// constant gives St Venant-Kirchhoff. docs/additive.md says how to choose.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "simulation/laws/strain_components.h"

namespace hookeye {
namespace {

using laws::CompiledAddend;
using laws::ComponentValues;
using laws::StrainEnergy;
using Gradients = Eigen::Matrix<double, 9, Eigen::Dynamic>;

/// B(J) = -k (J - b)^2 log(J / b) for J < b, else 0; with B' and B''.
Eigen::Vector3d barrier(double k, double b, double J) {
  if (k == 0 || J >= b) return Eigen::Vector3d::Zero();
  const double d = J - b, log = std::log(J / b);
  return {-k * d * d * log, -k * (2 * d * log + d * d / J),
          -k * (2 * log + 4 * d / J - d * d / (J * J))};
}

class Additive final : public EnergyTerm {
 public:
  explicit Additive(const AdditiveModel& model)
      : model_(model),
        turned_(!model.frame.isIdentity(0.0)),
        size_(model.size()),
        addends_(laws::compile(model)) {}
  const AdditiveModel& model() const { return model_; }

  std::string name() const override { return "additive"; }
  const CylinderFrame* cylinder() const override {
    return model_.cylinder ? &*model_.cylinder : nullptr;
  }
  int size() const override { return size_; }
  std::vector<Parameter> parameters(const Units& units) const override;
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& values) const override {
    AdditiveModel other = model_;
    other.set_values(values);
    return additive(other);
  }

  double psi(const Matrix3d& F) const override {
    const ComponentValues e(model_, in_frame(F), false);
    if (!e.admissible()) return std::numeric_limits<double>::infinity();
    double sum = barrier(model_.barrier_modulus, model_.barrier_below, e.deformation().J)[0];
    for (const CompiledAddend& a : addends_) sum += a.psi(e.values());
    return sum;
  }
  Matrix3d P(const Matrix3d& F) const override {
    const ComponentValues e(model_, in_frame(F), true);
    const StrainEnergy energy = over_strains(e);
    Matrix3d P = e.stress(energy.d1);
    if (e.deformation().J < model_.barrier_below)
      P += barrier(model_.barrier_modulus, model_.barrier_below, e.deformation().J)[1] *
           e.deformation().cof;
    return turned_ ? Matrix3d(P * model_.frame.transpose()) : P;
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    const ComponentValues e(model_, in_frame(F), true);
    Matrix9d D = e.stiffness(over_strains(e));
    if (e.deformation().J < model_.barrier_below) {
      const Eigen::Vector3d b =
          barrier(model_.barrier_modulus, model_.barrier_below, e.deformation().J);
      const laws::Vector9d c = laws::vec(e.deformation().cof);
      D.noalias() += (b[2] * c) * c.transpose();
      laws::add_d2J(b[1], e.deformation().F, D);
    }
    return turned_ ? stiffness_from_frame(D, model_.frame) : D;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    return laws::unvec(all_dP_dtheta(F).col(k));
  }
  Gradients all_dP_dtheta(const Matrix3d& F) const override {
    const ComponentValues e(model_, in_frame(F), true);
    Gradients all = Gradients::Zero(9, size_);
    Eigen::MatrixX2d d1;
    for (const CompiledAddend& a : addends_) {
      if (a.offset() < 0) continue;
      a.d1_basis(e.values(), d1);
      auto mine = all.middleCols(a.offset(), a.size());
      mine.noalias() += in_rest_axes(e.gradient(a.first())) * d1.col(0).transpose();
      if (a.second() >= 0)
        mine.noalias() += in_rest_axes(e.gradient(a.second())) * d1.col(1).transpose();
    }
    return all;
  }

 private:
  Matrix3d in_frame(const Matrix3d& F) const { return turned_ ? Matrix3d(F * model_.frame) : F; }
  laws::Vector9d in_rest_axes(const laws::Vector9d& g) const {
    return turned_ ? laws::vec(laws::unvec(g) * model_.frame.transpose()) : g;
  }
  StrainEnergy over_strains(const ComponentValues& e) const {
    StrainEnergy out;
    for (const CompiledAddend& a : addends_) a.add(e.values(), out);
    return out;
  }

  AdditiveModel model_;
  bool turned_;
  int size_;
  std::vector<CompiledAddend> addends_;
};

std::vector<Parameter> Additive::parameters(const Units& units) const {
  std::vector<Parameter> all;
  // What matters is a change as large as the stiffness of the model itself.
  double largest = 0.0;
  for (const Addend& a : model_.addends)
    if (!a.fixed) largest = std::max(largest, a.stiffness.cwiseAbs().maxCoeff());
  if (largest == 0.0) largest = 1.0;
  for (const Addend& a : model_.addends) {
    if (a.fixed) continue;
    const double scale = a.stiffness.cwiseAbs().maxCoeff();
    const size_t columns = a.second < 0 ? 1 : a.at_second.size();
    for (size_t i = 0; i < a.at.size(); ++i)
      for (size_t j = 0; j < columns; ++j) {
        Parameter p =
            laws::coefficient(fmt::format("{}.{}", a.name, i * columns + j + 1), "", units.stress(),
                              a.stiffness[static_cast<Eigen::Index>(i * columns + j)],
                              scale > 0 ? scale : 0.1 * largest);
        const std::string& first = model_.components[a.first].name;
        if (a.second < 0) {
          p.long_name = fmt::format("tangent modulus at {} = {:.4g}", first, a.at[i]);
          p.low = 0.0;  // convexity asks for it: no other addend bends along this axis alone
        } else {
          p.long_name = fmt::format("coupling modulus at {} = {:.4g}, {} = {:.4g}", first, a.at[i],
                                    model_.components[a.second].name, a.at_second[j]);
        }
        all.push_back(std::move(p));
      }
  }
  return all;
}

}  // namespace

std::shared_ptr<const EnergyTerm> additive(const AdditiveModel& model) {
  return std::make_shared<Additive>(model);
}

const AdditiveModel* additive_model(const EnergyTerm& law) {
  const auto* found = dynamic_cast<const Additive*>(&law);
  return found ? &found->model() : nullptr;
}

Eigen::VectorXd strains(const AdditiveModel& model, const Matrix3d& F) {
  const laws::ComponentValues e(model, F * model.frame, false);
  return Eigen::Map<const Eigen::VectorXd>(e.values().data(),
                                           static_cast<Eigen::Index>(model.components.size()));
}

}  // namespace hookeye
