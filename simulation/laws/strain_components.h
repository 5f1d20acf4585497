// The strain components of the additive law with their derivatives by F.
#pragma once

#include "simulation/laws/additive_addends.h"
#include "simulation/laws/invariants.h"

namespace hookeye::laws {

/// All components of a model at one F, in the material frame (F A). Gradients are 9-vectors.
class ComponentValues {
 public:
  /// Values only unless `gradients`.
  ComponentValues(const AdditiveModel& model, const Matrix3d& F, bool gradients);

  bool admissible() const { return d_.J > 0; }
  const Strains& values() const { return e_; }
  const Deformation& deformation() const { return d_; }

  /// sum_c d1_c de_c/dF, in the material frame.
  Matrix3d stress(const Strains& d1) const;
  /// dP/dF of the energy, in the material frame.
  Matrix9d stiffness(const StrainEnergy& energy) const;
  /// de_c/dF, where I1bar stands for the gradient of its square root (zero at rest).
  Vector9d gradient(int c) const;

 private:
  using Kind = StrainComponent::Kind;
  void set_gradient(int c, const StrainComponent& component);
  /// Psi'(g)/g and (Psi'' - Psi'/g)/g^2 of g = sqrt(I1bar - 3): finite at rest.
  struct Root {
    double first, second;
  };
  Root root(double d1, double d2, double g) const;
  void add_isochoric(const StrainEnergy& energy, int c, Matrix9d& D) const;

  const AdditiveModel& model_;
  Deformation d_;
  Strains e_{};
  /// For I1bar the gradient of I1bar itself.
  Eigen::Matrix<double, 9, Eigen::Dynamic, 0, 9, kMostComponents> g_;
};

}  // namespace hookeye::laws
