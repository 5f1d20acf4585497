// Materials of the exporters hold the energies that they stand for.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "exporters/solver_model.h"
#include "simulation/additive.h"

namespace hookeye::test {
namespace {

/// The head of exporters/solver_model.h, written out.
double energy_of(const SolverMaterial& m, const Matrix3d& F) {
  const double J = F.determinant();
  const Matrix3d C = F.transpose() * F, Cbar = std::pow(J, -2.0 / 3) * C;
  const double I1 = Cbar.trace(), I2 = 0.5 * (I1 * I1 - (Cbar * Cbar).trace());
  const Rubber& r = m.rubber;
  double W = r.c10 * (I1 - 3) + r.c01 * (I2 - 3) + r.c20 * std::pow(I1 - 3, 2) +
             r.c30 * std::pow(I1 - 3, 3) + 0.5 * r.kappa * (J - 1) * (J - 1);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> squares(Cbar);
  for (const auto& [mu, alpha] : r.ogden)
    W += mu / alpha * (squares.eigenvalues().array().pow(alpha / 2).sum() - 3);
  const Matrix3d E = 0.5 * (C - Matrix3d::Identity());
  Eigen::Matrix<double, 6, 1> e;
  e << E(0, 0), E(1, 1), E(2, 2), 2 * E(1, 2), 2 * E(0, 2), 2 * E(0, 1);
  return W + 0.5 * e.dot(m.linear * e);
}

Matrix3d strained(int seed) {
  std::srand(static_cast<unsigned>(seed));
  return Matrix3d::Identity() + 0.25 * Matrix3d::Random();
}

TetMesh two_tetrahedra() {
  TetMesh mesh;
  mesh.order = 1;
  mesh.X.resize(3, 5);
  mesh.X << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1;
  mesh.elements.resize(4, 2);
  mesh.elements << 0, 1, 1, 2, 2, 4, 3, 3;
  return mesh;
}

void expect_same(const EnergyModel& energy) {
  std::vector<std::string> lacks;
  const TetMesh mesh = two_tetrahedra();
  const auto materials = solver_materials(energy, mesh, lacks);
  EXPECT_TRUE(lacks.empty()) << lacks.front();
  size_t elements = 0;
  for (const SolverMaterial& m : materials)
    for (const int e : m.elements) {
      ++elements;
      for (int seed = 1; seed < 6; ++seed) {
        const Matrix3d F = strained(seed);
        double W = 0;
        for (const auto& part : energy.parts)
          W += (part.weight.size() ? part.weight[e] : 1.0) * part.psi(e, F);
        EXPECT_NEAR(energy_of(m, F), W, 1e-10 * std::abs(W) + 1e-14);
      }
    }
  EXPECT_EQ(elements, 2u);
}

TEST(SolverMaterials, HoldEveryLawOfRubber) {
  expect_same({{{neo_hookean(0.05, 0.5), {}}}, {}});
  expect_same({{{neo_hookean_tied(0.05, 12), {}}}, {}});
  expect_same({{{mooney_rivlin(0.03, -0.01, 0.4), {}}}, {}});
  expect_same({{{yeoh(0.03, -0.01, 0.004, 0.4), {}}}, {}});
  expect_same({{{ogden({0.04, -0.01}, {1.8, -2.5}, 0.5), {}}}, {}});
}

TEST(SolverMaterials, HoldLawsThatAreLinearInTheGreenStrain) {
  OrthotropicValues values;
  values.c << 0.4, 0.1, 0.12, 0.1, 0.3, 0.09, 0.12, 0.09, 0.25;
  values.g << 0, 0.05, 0.06, 0.05, 0, 0.07, 0.06, 0.07, 0;
  values.frame = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  expect_same({{{stvk(0.4, 0.05), {}}}, {}});
  expect_same({{{neo_hookean(0.05, 0.5), {}}, {orthotropic(values), {}}}, {}});
}

TEST(SolverMaterials, HoldSumsAndAdditiveConstants) {
  expect_same({{{neo_hookean(0.05, 0.5), {}},
                {combination({{0.3, stvk(0.4, 0.05)}, {-0.3, neo_hookean(0.05, 0.5)}}), {}}},
               {}});
  expect_same({{{additive(additive_neo_hookean(0.05, 0.5)), {}}}, {}});
  expect_same({{{additive(additive_stvk(0.4, 0.05)), {}}}, {}});
}

TEST(SolverMaterials, DifferWhereWeightsDo) {
  EnergyModel energy{{{neo_hookean(0.05, 0.5), {}}}, {}};
  energy.parts[0].weight = Eigen::Vector2d(1.0, 2.5);
  expect_same(energy);
}

TEST(SolverMaterials, SayWhatTheyLack) {
  std::vector<std::string> lacks;
  AdditiveModel curve = additive_neo_hookean(0.05, 0.5);
  curve = refined(curve, 0, 0.4);
  EnergyModel energy{{{additive(curve), {}}, {fibre(0.1, Vector3d::UnitX()), {}}}, {}};
  const auto materials = solver_materials(energy, two_tetrahedra(), lacks);
  EXPECT_EQ(lacks.size(), 2u);
  EXPECT_NEAR(materials.at(0).rubber.c10, 0.025, 1e-12);
  EXPECT_NEAR(materials.at(0).rubber.kappa, 0.5, 1e-12);
}

TEST(SolverMaterials, RoundWeightsThatAreMany) {
  TetMesh mesh = two_tetrahedra();
  const Eigen::MatrixXi pair = mesh.elements;
  mesh.elements.resize(4, 400);
  for (int k = 0; k < 200; ++k) mesh.elements.middleCols(2 * k, 2) = pair;
  EnergyModel energy{{{neo_hookean(0.05, 0.5), {}}}, {}};
  energy.parts[0].weight = VectorXd::LinSpaced(400, 0.5, 2.0);
  std::vector<std::string> lacks;
  const auto materials = solver_materials(energy, mesh, lacks);
  EXPECT_EQ(lacks.size(), 1u);
  EXPECT_LT(materials.size(), 300u);
  for (const SolverMaterial& m : materials)
    for (const int e : m.elements)
      EXPECT_NEAR(m.rubber.kappa, 0.5 * energy.parts[0].weight[e], 0.0026 * m.rubber.kappa);
}

}  // namespace
}  // namespace hookeye::test
