// Potential, residual and tangent of every force and of the elements, against each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "simulation/blocks.h"
#include "simulation/equilibrium.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::MatrixXd;

VectorXd deformed(const TetMesh& mesh, double amount = 0.05) {
  const Eigen::Matrix3d F = Eigen::Matrix3d::Identity() + 0.3 * test::noise(9, 3).reshaped(3, 3);
  return VectorXd((F * mesh.X).reshaped()) + amount * test::noise(3 * mesh.nodes(), 5);
}

Region top(const TetMesh& mesh) {
  const double z = mesh.X.row(2).maxCoeff();
  return test::region_where(mesh, [z](const Vector3d& X) { return X.z() > z - 1e-9; });
}

Region everywhere(const TetMesh& mesh) {
  return test::region_where(mesh, [](const Vector3d&) { return true; });
}

TetMesh small(int order) { return test::block(2, 2, 2, {2, 1.5, 1}, order, 0.2); }

MatrixXd dense_tangent(const ForceTerm& force, const TetMesh& mesh, const VectorXd& q, double s) {
  Triplets triplets;
  force.add_tangent(mesh, q, s, triplets);
  MatrixXd K = MatrixXd::Zero(q.size(), q.size());
  for (const auto& t : triplets) K(t.row(), t.col()) += t.value();
  return K;
}

VectorXd residual_of(const ForceTerm& force, const TetMesh& mesh, const VectorXd& q, double s) {
  VectorXd R = VectorXd::Zero(q.size());
  force.add_residual(mesh, q, s, R);
  return R;
}

void check_potential(const ForceTerm& force, const TetMesh& mesh, const VectorXd& q,
                     const std::string& what) {
  const VectorXd d = test::noise(q.size(), 11);
  const auto f = [&](double h) {
    return VectorXd::Constant(1, force.potential(mesh, q + h * d, 0.7));
  };
  test::expect_derivative(f, VectorXd::Constant(1, residual_of(force, mesh, q, 0.7).dot(d)), 1e-4,
                          1e-7, what);
}

void check_tangent(const ForceTerm& force, const TetMesh& mesh, const VectorXd& q,
                   const std::string& what, double h = 1e-4) {
  const VectorXd d = test::noise(q.size(), 12);
  const auto f = [&](double t) { return residual_of(force, mesh, q + t * d, 0.7); };
  const MatrixXd K = dense_tangent(force, mesh, q, 0.7);
  EXPECT_LE((K - K.transpose()).norm(), 1e-13 * K.norm()) << what;
  test::expect_derivative(f, K * d, h, 1e-7, what);
}

class Forces : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, Forces, testing::Values(1, 2));

TEST_P(Forces, DeadForceAndWeight) {
  const TetMesh mesh = small(GetParam());
  const VectorXd q = deformed(mesh);
  const auto force = dead_force(top(mesh), Vector3d(1, -2, 3));
  const auto weight = self_weight(mesh, 2.0, Vector3d(0.5, 0, -9));
  check_potential(*force, mesh, q, "dead force");
  check_potential(*weight, mesh, q, "weight");
  const VectorXd F = -residual_of(*force, mesh, q, 1.0), W = -residual_of(*weight, mesh, q, 1.0);
  EXPECT_LE((F.reshaped(3, mesh.nodes()).rowwise().sum() - Vector3d(1, -2, 3)).norm(), 1e-13);
  EXPECT_LE((W.reshaped(3, mesh.nodes()).rowwise().sum() - 3.0 * 2.0 * Vector3d(0.5, 0, -9)).norm(),
            1e-12);
}

TEST(Weight, IsConsistentInEachElement) {
  TetMesh mesh = test::block(1, 1, 1, {1, 1, 1}, 2);
  mesh.elements.conservativeResize(10, 1);
  const VectorXd W =
      -residual_of(*self_weight(mesh, 1.0, Vector3d(0, 0, 1)), mesh, mesh.X.reshaped(), 1.0);
  for (int i = 0; i < 10; ++i)
    EXPECT_NEAR(W[3 * mesh.elements(i, 0) + 2], (i < 4 ? -1.0 / 20 : 1.0 / 5) / 6, 1e-15);
}

TEST_P(Forces, PressureOnClosedSurface) {
  const TetMesh mesh = small(GetParam());
  const VectorXd q = deformed(mesh);
  const auto pressure = follower_pressure(everywhere(mesh), 0.3);
  check_potential(*pressure, mesh, q, "pressure");
  check_tangent(*pressure, mesh, q, "pressure");
  // No resultant, and squeezing: at rest the work on a uniform shrinking is p times 3 V.
  const VectorXd X = mesh.X.reshaped(), f = -residual_of(*pressure, mesh, X, 1.0);
  EXPECT_LE(f.reshaped(3, mesh.nodes()).rowwise().sum().norm(), 1e-13);
  EXPECT_NEAR(-f.dot(X), 0.3 * 3 * 3.0, 1e-12);
}

MatrixXd dense_skew(const ForceTerm& force, const TetMesh& mesh, const VectorXd& q, double s) {
  Triplets triplets;
  force.add_skew_tangent(mesh, q, s, triplets);
  MatrixXd W = MatrixXd::Zero(q.size(), q.size());
  for (const auto& t : triplets) W(t.row(), t.col()) += t.value();
  return W;
}

TEST_P(Forces, PressureOnPatchHasATangentOfTwoParts) {
  const TetMesh mesh = test::block(4, 4, 1, {2, 1.5, 1}, GetParam());
  const auto pressure = follower_pressure(top(mesh), 0.3);
  const VectorXd q = deformed(mesh), d = test::noise(q.size(), 12);
  const MatrixXd K = dense_tangent(*pressure, mesh, q, 0.7),
                 W = dense_skew(*pressure, mesh, q, 0.7);
  EXPECT_EQ(W, MatrixXd(-W.transpose()));
  EXPECT_EQ(K, MatrixXd(K.transpose()));
  EXPECT_GT(W.norm(), 0.1 * K.norm());
  test::expect_derivative([&](double t) { return residual_of(*pressure, mesh, q + t * d, 0.7); },
                          (K + W) * d, 1e-4, 1e-8, "pressure on a patch");
  // The rim alone has the skew part.
  const auto inner = [&](double x, double most) { return x > 1e-9 && x < most - 1e-9; };
  for (int a = 0; a < mesh.nodes(); ++a)
    if (inner(mesh.X(0, a), 2) && inner(mesh.X(1, a), 1.5)) {
      EXPECT_LE(W.middleRows<3>(3 * a).norm(), 1e-14 * W.norm()) << a;
    }
  Loading loading;
  loading.forces = {pressure};
  EXPECT_LE((MatrixXd(tangent(mesh, EnergyModel{}, loading, q, 0.7)) - K - W).norm(),
            1e-12 * K.norm());
  EXPECT_EQ(dense_skew(*follower_pressure(everywhere(mesh), 0.3), mesh, q, 1.0).norm(), 0.0);
}

TEST_P(Forces, PressureOnPatchFollowsTheNormalAndHasTheTangentOfAHeldRim) {
  const TetMesh mesh = test::block(4, 4, 1, {2, 1.5, 1}, GetParam());
  const Region patch = top(mesh);
  const auto pressure = follower_pressure(patch, 0.3);
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(0.8, Vector3d(1, 2, 3).normalized()).matrix();
  const VectorXd turned = (Q * mesh.X).reshaped();
  const VectorXd f = -residual_of(*pressure, mesh, turned, 1.0);
  EXPECT_LE((f.reshaped(3, mesh.nodes()).rowwise().sum() + 0.3 * 3.0 * Q.col(2)).norm(), 1e-13);
  // Directions that leave the rim alone.
  VectorXd d = test::noise(3 * mesh.nodes(), 13);
  for (int a = 0; a < mesh.nodes(); ++a)
    if (mesh.X(0, a) < 1e-9 || mesh.X(0, a) > 2 - 1e-9 || mesh.X(1, a) < 1e-9 ||
        mesh.X(1, a) > 1.5 - 1e-9)
      d.segment<3>(3 * a).setZero();
  const VectorXd q = deformed(mesh);
  const auto r = [&](double h) {
    VectorXd R = residual_of(*pressure, mesh, q + h * d, 1.0);
    for (Eigen::Index u = 0; u < d.size(); ++u)
      if (d[u] == 0) R[u] = 0;
    return R;
  };
  VectorXd Kd = dense_tangent(*pressure, mesh, q, 1.0) * d;
  for (Eigen::Index u = 0; u < d.size(); ++u)
    if (d[u] == 0) Kd[u] = 0;
  test::expect_derivative(r, Kd, 1e-4, 1e-8, "pressure on a patch");
}

TEST_P(Forces, Foundation) {
  const TetMesh mesh = small(GetParam());
  const VectorXd q = deformed(mesh), X = mesh.X.reshaped();
  const auto springs = elastic_foundation(top(mesh), 4.0, 0.7, X);
  check_potential(*springs, mesh, q, "foundation");
  check_tangent(*springs, mesh, q, "foundation");
  // Moved as a whole: traction times area, stiff along the normal z, soft along x.
  const VectorXd moved = (mesh.X.colwise() + Vector3d(0.2, 0, 0.1)).reshaped();
  const Vector3d f =
      -residual_of(*springs, mesh, moved, 1.0).reshaped(3, mesh.nodes()).rowwise().sum();
  EXPECT_LE((f - Vector3d(-0.7 * 0.2 * 3, 0, -4.0 * 0.1 * 3)).norm(), 1e-12);
  // No direction of negative stiffness, corner nodes included.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(dense_tangent(*springs, mesh, X, 1.0));
  EXPECT_GE(eigen.eigenvalues()[0], -1e-14);
  EXPECT_EQ((eigen.eigenvalues().array() > 1e-9).count(),
            3 * static_cast<int>(top(mesh).nodes.size()));
}

/// The rim of a patch may cross faces: of such a face its share counts, in force and tangent alike.
TEST_P(Forces, SharesOfFacesCount) {
  const TetMesh mesh = small(GetParam());
  const VectorXd q = deformed(mesh), d = test::noise(q.size(), 12), X = mesh.X.reshaped();
  const Region whole = top(mesh);
  Region part = whole, rest = whole;
  ASSERT_GE(whole.faces.size(), 8u);
  for (size_t i = 0; i < whole.faces.size(); ++i) {
    part.faces[i].second = 0.1 + 0.1 * static_cast<double>(i % 8);
    rest.faces[i].second = 1.0 - part.faces[i].second;
  }
  const auto pressure = [](const Region& patch) { return follower_pressure(patch, 0.3); };
  const auto springs = [&](const Region& patch) { return elastic_foundation(patch, 4.0, 0.7, X); };
  const auto check = [&](const auto& on, const std::string& what) {
    const auto force = on(part);
    const VectorXd R = residual_of(*on(whole), mesh, q, 0.7);
    const VectorXd both = residual_of(*force, mesh, q, 0.7) + residual_of(*on(rest), mesh, q, 0.7);
    EXPECT_LE((both - R).norm(), 1e-13 * R.norm()) << what;
    const MatrixXd K = dense_tangent(*force, mesh, q, 0.7), W = dense_skew(*force, mesh, q, 0.7);
    test::expect_derivative([&](double t) { return residual_of(*force, mesh, q + t * d, 0.7); },
                            (K + W) * d, 1e-4, 1e-7, what);
  };
  check(pressure, "pressure");
  check(springs, "foundation");
  check_potential(*springs(part), mesh, q, "foundation");
}

TEST_P(Forces, Floor) {
  const TetMesh mesh = small(GetParam());
  const VectorXd q = deformed(mesh);
  const auto floor = floor_contact(mesh, Vector3d(0, 0, 0.45), Vector3d(0.1, 0, 1), 5.0, 0.3);
  check_potential(*floor, mesh, q, "floor");
  check_tangent(*floor, mesh, q, "floor", 1e-6);  // the tangent is only C0
  EXPECT_EQ(
      residual_of(*floor_contact(mesh, Vector3d(0, 0, -9), Vector3d::UnitZ(), 5, 0.3), mesh, q, 1)
          .norm(),
      0);
  // A block sunk by 1 with smoothing 0.3: k (d - h/2) on the lower face, 0 on top where d = 0.
  const VectorXd X = mesh.X.reshaped();
  const auto flat = floor_contact(mesh, Vector3d(0, 0, 1.0), Vector3d::UnitZ(), 5.0, 1e-6);
  Vector3d f = Vector3d::Zero();
  const VectorXd R = residual_of(*flat, mesh, X, 1);
  for (int a = 0; a < mesh.nodes(); ++a) f -= R.segment<3>(3 * a);
  const double sides = 2 * (2 + 1.5) * 5.0 * 0.5;  // mean depth 1/2 over the side faces
  EXPECT_NEAR(f.z(), 5.0 * 3.0 + sides, 1e-3);
}

/// A corner first: of what is behind a plane across it, k times the volume over the three faces.
TEST_P(Forces, AFloorMeetsACorner) {
  const TetMesh mesh = test::block(2, 2, 2, {2, 2, 2}, GetParam());
  for (const double sunk : {0.4, 0.9}) {  // less than an edge of an element, which is 1
    const Vector3d n = Vector3d::Ones().normalized(), through = sunk * n;
    const auto floor = floor_contact(mesh, through, n, 5.0, 1e-6);
    Vector3d f = Vector3d::Zero();
    const VectorXd R = residual_of(*floor, mesh, mesh.X.reshaped(), 1);
    for (int a = 0; a < mesh.nodes(); ++a) f -= R.segment<3>(3 * a);
    const double side = std::sqrt(3.0) * sunk, one_face = 0.5 * side * side * sunk / 3.0;
    EXPECT_NEAR(f.norm(), 5.0 * 3.0 * one_face, 0.02 * 5.0 * 3.0 * one_face) << sunk;
    EXPECT_GT(f.normalized().dot(n), 1.0 - 1e-9);
  }
}

EnergyModel mixed(const TetMesh& mesh) {
  EnergyModel energy;
  energy.parts.push_back(
      {neo_hookean(0.05, 0.6), (1.5 + test::noise(mesh.size(), 21).array()).matrix()});
  energy.parts.push_back({fibre(0.03, Vector3d(1, 1, 0)), {}});
  energy.swelling = 1.1 + 0.05 * test::noise(mesh.size(), 22).array();
  return energy;
}

TEST_P(Forces, ElementsEnergyForcesTangent) {
  const TetMesh mesh = small(GetParam());
  const EnergyModel energy = mixed(mesh);
  const VectorXd q = deformed(mesh, 0.02), d = test::noise(q.size(), 31);
  const VectorXd R = residual(mesh, energy, Loading{}, q);
  test::expect_derivative(
      [&](double h) { return VectorXd::Constant(1, internal_energy(mesh, energy, q + h * d)); },
      VectorXd::Constant(1, R.dot(d)), 1e-4, 1e-8, "energy");
  Loading loading;
  loading.forces = {follower_pressure(everywhere(mesh), 0.02),
                    self_weight(mesh, 1, Vector3d(0, 0, -1)),
                    elastic_foundation(top(mesh), 0.3, 0.1, mesh.X.reshaped())};
  const SparseMatrix K = tangent(mesh, energy, loading, q, 0.6);
  EXPECT_LE((K - SparseMatrix(K.transpose())).norm(), 1e-14 * K.norm());
  test::expect_derivative([&](double h) { return residual(mesh, energy, loading, q + h * d, 0.6); },
                          K * d, 1e-4, 1e-8, "tangent");
  const MatrixXd each = element_forces(mesh, energy, q);
  VectorXd sum = VectorXd::Zero(q.size());
  for (int e = 0; e < mesh.size(); ++e)
    for (int i = 0; i < mesh.nodes_per_element(); ++i)
      sum.segment<3>(3 * mesh.elements(i, e)) += each.col(e).segment<3>(3 * i);
  EXPECT_LE((sum - R).norm(), 1e-14 * each.norm());
}

TEST_P(Forces, ParameterDerivativeOfForces) {
  const TetMesh mesh = small(GetParam());
  const EnergyModel energy = mixed(mesh);
  const VectorXd q = deformed(mesh, 0.02);
  const VectorXd base[2] = {Eigen::Vector2d(0.05, 0.6), Eigen::Vector4d(0.03, 1, 1, 0)};
  for (int part = 0; part < 2; ++part) {
    const MatrixXd all = all_dR_dtheta(mesh, energy, q, part);
    ASSERT_EQ(all.cols(), base[part].size());
    for (int k = 0; k < base[part].size(); ++k) {
      const VectorXd one = dR_dtheta(mesh, energy, q, part, k);
      test::expect_derivative(
          [&](double h) {
            EnergyModel other = energy;
            VectorXd v = base[part];
            v[k] += h;
            other.parts[part].term = energy.parts[part].term->with(v);
            return residual(mesh, other, Loading{}, q);
          },
          one, 1e-4, 1e-8, fmt::format("part {} parameter {}", part, k));
      EXPECT_LE((all.col(k) - one).norm(), 1e-13 * one.norm()) << part << " " << k;
    }
  }
}

TEST_P(Forces, SwollenFreeBodyIsStressFree) {
  const TetMesh mesh = small(GetParam());
  EnergyModel energy;
  energy.parts.push_back({neo_hookean(0.05, 0.6), {}});
  energy.swelling = VectorXd::Constant(mesh.size(), 1.2);
  EXPECT_LE(residual(mesh, energy, Loading{}, 1.2 * mesh.X.reshaped()).norm(), 1e-14);
  EXPECT_GT(residual(mesh, energy, Loading{}, mesh.X.reshaped()).norm(), 1e-3);
}

TEST(Loading, PrescribeOverrideRelease) {
  const TetMesh mesh = small(1);
  Loading loading;
  const Region region = top(mesh);
  loading.prescribe(mesh, region, 2, 0.5);
  loading.prescribe(mesh, everywhere(mesh), 2, 0.1);
  loading.prescribe(mesh, region, 0, 0.3);
  EXPECT_TRUE(std::is_sorted(loading.prescribed.begin(), loading.prescribed.end()));
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    EXPECT_EQ(loading.displacement[static_cast<int>(i)],
              loading.prescribed[i] % 3 == 0 ? 0.3 : 0.1);
  loading.release(region);
  for (int u : loading.prescribed) EXPECT_LT(mesh.X(2, u / 3), 1 - 1e-9);
  RigidMotion motion;
  motion.axis = Vector3d::UnitX();
  motion.degrees = 90;
  loading.prescribe_rigid(mesh, region, motion);
  for (size_t i = 0; i < loading.prescribed.size(); ++i) {
    const int a = loading.prescribed[i] / 3;
    if (!std::binary_search(region.nodes.begin(), region.nodes.end(), a)) continue;
    const Vector3d x(mesh.X(0, a), -mesh.X(2, a), mesh.X(1, a));
    const int c = loading.prescribed[i] % 3;
    EXPECT_NEAR(loading.displacement[static_cast<int>(i)], x[c] - mesh.X(c, a), 1e-14);
  }
}

TEST(Loading, NamesFreeRigidMotions) {
  const TetMesh mesh = small(1);
  Loading loading;
  EXPECT_EQ(free_rigid_motions(mesh, loading).size(), 6u);
  const Region lower = test::region_where(mesh, [](const Vector3d& X) { return X.z() < 1e-9; });
  loading.prescribe(mesh, lower, 2, 0);
  auto names = free_rigid_motions(mesh, loading);
  ASSERT_EQ(names.size(), 3u);
  loading.prescribe(mesh, lower, 1, 0);
  names = free_rigid_motions(mesh, loading);
  ASSERT_EQ(names.size(), 1u);
  EXPECT_EQ(names[0], "translation along (1, 0, 0)");
  // A hinge: the edge x = 0, z = 0 held in all directions.
  Loading hinge;
  Region edge;
  for (int a = 0; a < mesh.nodes(); ++a)
    if (mesh.X(0, a) < 1e-9 && mesh.X(2, a) < 1e-9) edge.nodes.push_back(a);
  for (int i = 0; i < 3; ++i) hinge.prescribe(mesh, edge, i, 0);
  names = free_rigid_motions(mesh, hinge);
  ASSERT_EQ(names.size(), 1u);
  EXPECT_NE(names[0].find("rotation about (0, 1, 0) through (0, "), std::string::npos) << names[0];
  EXPECT_NE(names[0].find(", 0)", 30), std::string::npos) << names[0];
  for (int i = 0; i < 3; ++i) loading.prescribe(mesh, lower, i, 0);
  EXPECT_TRUE(free_rigid_motions(mesh, loading).empty());
}

}  // namespace
}  // namespace hookeye
