// Laws that effects add to others: fibres that only pull, orthotropic stiffnesses, combinations.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "simulation/blocks.h"
#include "simulation/energy_term.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using Law = std::shared_ptr<const EnergyTerm>;

Matrix3d some_frame() {
  return Eigen::AngleAxisd(0.8, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
}

Matrix3d some_deformation(unsigned seed) {
  return some_frame().transpose() * (Matrix3d(Vector3d(1.4, 1.35, 0.75).asDiagonal()) +
                                     0.1 * test::noise(9, seed).reshaped(3, 3));
}

PullingFibreValues pulling(double k2, bool volume_counts) {
  PullingFibreValues v;
  v.k1 = 0.08, v.k2 = k2, v.direction = Vector3d(1, 0.2, -0.1), v.volume_counts = volume_counts;
  return v;
}

OrthotropicValues some_orthotropic() {
  VectorXd x(9);
  x << 0.3, 0.2, 0.25, 0.1, 0.12, 0.08, 0.05, 0.07, 0.03;
  return orthotropic_values(x, some_frame());
}

Stiffness6 some_stiffness() {
  const Stiffness6 A = 0.3 * test::noise(36, 5).reshaped(6, 6);
  return A + A.transpose();
}

TEST(Addends, DerivativesAreThoseOfTheEnergy) {
  for (const Law& law : {pulling_fibre(pulling(0.0, false)), pulling_fibre(pulling(0.7, false)),
                         pulling_fibre(pulling(0.7, true)), orthotropic(some_orthotropic()),
                         anisotropic(some_stiffness()),
                         combination({{0.7, stvk(0.3, 0.05)}, {-0.4, neo_hookean(0.05, 0.4)}})})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const Matrix3d F = some_deformation(seed);
      const Matrix9d D = law->dP_dF(F);
      EXPECT_LE((D - D.transpose()).norm(), 1e-13 * D.norm()) << law->name();
      for (int k = 0; k < 9; ++k) {
        Matrix3d direction = Matrix3d::Zero();
        direction(k % 3, k / 3) = 1;
        const auto energy = [&](double h) {
          return VectorXd::Constant(1, law->psi(F + h * direction));
        };
        test::expect_derivative(energy, VectorXd::Constant(1, law->P(F)(k % 3, k / 3)), 1e-3, 1e-6,
                                law->name());
        const auto stress = [&](double h) {
          return VectorXd(law->P(F + h * direction).reshaped());
        };
        test::expect_derivative(stress, D.col(k), 1e-4, 1e-7, law->name());
      }
      const auto parameters = law->parameters(Units{"mm", "N"});
      VectorXd p(static_cast<Eigen::Index>(parameters.size()));
      for (int k = 0; k < p.size(); ++k) p[k] = parameters[k].value;
      for (int k = 0; k < p.size(); ++k) {
        const auto by_parameter = [&](double h) {
          VectorXd v = p;
          v[k] += h;
          return VectorXd(law->with(v)->P(F).reshaped());
        };
        test::expect_derivative(by_parameter, law->dP_dtheta(F, k).reshaped(), 1e-4, 1e-6,
                                law->name() + " " + parameters[k].name);
      }
    }
}

TEST(Addends, PullingFibresAreHolzapfelsAndSlackInCompression) {
  const PullingFibreValues v = pulling(0.7, false);
  HolzapfelValues h;
  h.k1 = v.k1, h.k2 = v.k2, h.toe = v.toe, h.directions = {v.direction.normalized()};
  const Law ours = pulling_fibre(v), theirs = holzapfel(h);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Matrix3d F = some_deformation(seed);
    EXPECT_GT(ours->psi(F), 0.0);
    EXPECT_NEAR(ours->psi(F), theirs->psi(F), 1e-14);
    EXPECT_LE((ours->P(F) - theirs->P(F)).norm(), 1e-14);
    EXPECT_LE((ours->dP_dF(F) - theirs->dP_dF(F)).norm(), 1e-13);
  }
  Matrix3d pressed = Matrix3d::Identity() - 0.2 * v.direction * v.direction.transpose();
  EXPECT_EQ(ours->P(pressed), Matrix3d(Matrix3d::Zero()));
  EXPECT_EQ(ours->dP_dF(pressed), Matrix9d(Matrix9d::Zero()));
}

TEST(Addends, OrthotropicWithIsotropicStiffnessesIsStVk) {
  const double lambda = 0.3, mu = 0.05;
  VectorXd x(9);
  x << VectorXd::Constant(3, lambda + 2 * mu), VectorXd::Constant(3, lambda),
      VectorXd::Constant(3, mu);
  const Law ours = orthotropic(orthotropic_values(x, some_frame())), theirs = stvk(lambda, mu);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Matrix3d F = some_deformation(seed);
    EXPECT_NEAR(ours->psi(F), theirs->psi(F), 1e-14);
    EXPECT_LE((ours->P(F) - theirs->P(F)).norm(), 1e-14);
    EXPECT_LE((ours->dP_dF(F) - theirs->dP_dF(F)).norm(), 1e-13);
  }
}

TEST(Addends, StiffnessesInAFrameAndInRestAxesAreTheSameLaw) {
  const OrthotropicValues v = some_orthotropic();
  const Law ours = anisotropic(voigt_stiffness(v)), theirs = orthotropic(v);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Matrix3d F = some_deformation(seed), E = 0.5 * (F.transpose() * F - Matrix3d::Identity());
    const Matrix3d own = v.frame.transpose() * E * v.frame;
    const double W = 0.5 * own.diagonal().dot(v.c * own.diagonal()) +
                     v.g.cwiseProduct(own).cwiseProduct(own).sum();
    EXPECT_NEAR(ours->psi(F), W, 1e-14);
    EXPECT_NEAR(theirs->psi(F), W, 1e-14);
    EXPECT_LE((ours->P(F) - theirs->P(F)).norm(), 1e-13);
  }
  OrthotropicValues told = v;
  told.frame.setIdentity();
  EXPECT_LE((stiffness_in_frame(voigt_stiffness(v), v.frame) - voigt_stiffness(told)).norm(),
            1e-14);
}

TEST(Addends, ACombinationIsInadmissibleWhereOneOfItsTermsIs) {
  const Law law = combination({{1.0, stvk(0.3, 0.05)}, {-1.0, neo_hookean(0.05, 0.4)}});
  const Matrix3d inverted = Vector3d(1, 1, -0.5).asDiagonal();
  EXPECT_EQ(law->psi(inverted), std::numeric_limits<double>::infinity());
  const Matrix3d F = some_deformation(1);
  EXPECT_NEAR(law->psi(F), stvk(0.3, 0.05)->psi(F) - neo_hookean(0.05, 0.4)->psi(F), 1e-14);
}

}  // namespace
}  // namespace hookeye
