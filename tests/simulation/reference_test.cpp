// Against CalculiX on the shared reference meshes.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "simulation/blocks.h"
#include "simulation/equilibrium.h"
#include "support/shared_data.h"

namespace hookeye {
namespace {

struct Reference {
  std::string name;
  Vector3d reaction;
  double potential;
};

class CalculiX : public testing::TestWithParam<Reference> {};

Loading stretch_and_bend(const TetMesh& mesh) {
  Loading loading;
  loading.name = "A";
  const double phi = M_PI / 4, r = 130 / phi;
  const Vector3d c(r * std::sin(phi), 15, 10 + r * (1 - std::cos(phi)));
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-phi, Vector3d::UnitY()).matrix();
  std::vector<double> u;
  for (int a = 0; a < mesh.nodes(); ++a) {
    const Vector3d X = mesh.X.col(a);
    Vector3d d = Vector3d::Zero();
    if (X.x() > 100 - 1e-6)
      d = c + R * (X - Vector3d(100, 15, 10)) - X;
    else if (X.x() > 1e-6)
      continue;
    for (int i = 0; i < 3; ++i) {
      loading.prescribed.push_back(3 * a + i);
      u.push_back(d[i]);
    }
  }
  loading.displacement = Eigen::Map<VectorXd>(u.data(), static_cast<Eigen::Index>(u.size()));
  return loading;
}

Loading heavy_cantilever(const TetMesh& mesh) {
  Loading loading;
  loading.name = "B";
  for (int a = 0; a < mesh.nodes(); ++a)
    for (int i = 0; i < 3 && mesh.X(0, a) < 1e-6; ++i) loading.prescribed.push_back(3 * a + i);
  loading.displacement = VectorXd::Zero(static_cast<Eigen::Index>(loading.prescribed.size()));
  loading.forces.push_back(self_weight(mesh, 1.07e-9, Vector3d(0, 0, -9810)));
  return loading;
}

TEST_P(CalculiX, DisplacementsReactionsEnergy) {
  HOOKEYE_NEEDS_DATA("reference");
  const Reference& reference = GetParam();
  const auto folder = test::shared_data() / "reference";
  const TetMesh mesh = test::read_reference_mesh(folder / (reference.name.substr(0, 4) + ".mesh"));
  const bool bend = reference.name.back() == 'A';
  EnergyModel energy;
  energy.parts.push_back({bend ? neo_hookean(0.1, 7.0 / 15) : neo_hookean(0.03, 0.14), {}});
  const Loading loading = bend ? stretch_and_bend(mesh) : heavy_cantilever(mesh);
  const auto result = solve_equilibrium(mesh, energy, loading);
  ASSERT_TRUE(result.has_value()) << result.error().reason << " at "
                                  << result.error().load_fraction;
  const Equilibrium& e = *result;
  EXPECT_TRUE(e.stable);
  EXPECT_LE(test::distance_to_reference(folder / (reference.name + ".csv"), mesh, e.q), 2e-5);

  // CalculiX leaves out the load that acts directly on fixed nodes, so compare internal forces.
  VectorXd R = residual(mesh, energy, Loading{}, e.q);
  Vector3d reaction = Vector3d::Zero();
  for (int a = 0; a < mesh.nodes(); ++a)
    if (mesh.X(0, a) < 1e-6) reaction += R.segment<3>(3 * a);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(reaction[i], reference.reaction[i], 2e-5 * reference.reaction.norm());
  double potential = internal_energy(mesh, energy, e.q);
  for (const auto& f : loading.forces) potential += f->potential(mesh, e.q, 1.0);
  EXPECT_NEAR(potential, reference.potential, 2e-7 * std::abs(reference.potential));
  std::printf("%s: %d Newton iterations, %d factorizations\n", reference.name.c_str(),
              e.newton_iterations, e.factorizations);
}

INSTANTIATE_TEST_SUITE_P(
    Block, CalculiX,
    testing::Values(Reference{"b10k_A", {-33.79339, 0, -13.99576}, 572.4295131},
                    Reference{"q10k_A", {-33.60680, -3.3e-4, -13.91989}, 566.9241772},
                    Reference{"q30k_A", {-33.57261, -7.1e-4, -13.90586}, 566.0779077},
                    Reference{"b10k_B", {0, 0, 0.6210895}, -5.251824363},
                    Reference{"q10k_B", {0, 0, 0.6246217}, -5.645449175},
                    Reference{"q30k_B", {0, 0, 0.6260792}, -5.667310664}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace hookeye
