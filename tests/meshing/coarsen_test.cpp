// Surfaces much finer than the mesh that fills them.
#include "meshing/coarsen.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>

#include "meshing/detail.h"
#include "meshing/tet_mesh.h"
#include "shapes.h"

namespace hookeye {
namespace {

using testing::HasSubstr;

const Place kPlace{"capture.yaml", 5, 3};

/// A box's corners drawn onto a ball of radius 1 about (1, 1, 1).
SurfaceMesh ball(int cuts) {
  SurfaceMesh s = test::box_surface({2, 2, 2}, cuts);
  for (auto x : s.X.colwise()) x = Vector3d::Ones() + (x - Vector3d::Ones()).normalized();
  s.uv.clear();
  return s;
}

/// A round bar along z, its ends plane: radius 1, length 3.
SurfaceMesh bar(int around, int along) {
  SurfaceMesh s;
  s.X.resize(3, around * (along + 1) + 2);
  for (int k = 0; k <= along; ++k)
    for (int i = 0; i < around; ++i) {
      const double a = 2.0 * std::numbers::pi * i / around;
      s.X.col(k * around + i) << std::cos(a), std::sin(a), 3.0 * k / along;
    }
  const int low = around * (along + 1), high = low + 1;
  s.X.col(low) << 0, 0, 0;
  s.X.col(high) << 0, 0, 3;
  for (int i = 0; i < around; ++i) {
    const int j = (i + 1) % around, top = around * along;
    s.triangles.push_back({low, j, i});
    s.triangles.push_back({high, top + i, top + j});
    for (int k = 0; k < along; ++k) {
      const int a = k * around + i, b = k * around + j;
      s.triangles.push_back({a, b, b + around});
      s.triangles.push_back({a, b + around, a + around});
    }
  }
  return s;
}

TEST(Coarsen, ARoundBodyKeepsItsVolume) {
  const SurfaceMesh fine = ball(40);  // 19,200 triangles with edges of 0.03 to 0.05
  const detail::Subdivided coarse = detail::coarsened(fine, 0.4, 0.02);
  EXPECT_TRUE(inspect(coarse.mesh).clean());
  EXPECT_LT(coarse.mesh.triangles.size(), 600U);
  EXPECT_GT(coarse.mesh.triangles.size(), 150U) << "edges between half of the target and all of it";
  EXPECT_NEAR(detail::six_volume(coarse.mesh) / detail::six_volume(fine), 1.0, 2e-3);
  EXPECT_LT(detail::apart(fine, coarse.mesh), 0.04);
  EXPECT_THAT(coarse.parent, testing::Each(detail::kSeveral));
}

TEST(Coarsen, PlaneFacesStayPlaneAndEdgesSharp) {
  SurfaceMesh fine = test::box_surface({3, 2, 1}, 24);
  fine.uv.clear();
  const detail::Subdivided coarse = detail::coarsened(fine, 0.5, 0.01);
  EXPECT_LT(coarse.mesh.triangles.size(), fine.triangles.size() / 8);
  EXPECT_NEAR(detail::six_volume(coarse.mesh), 36.0, 1e-9);
  EXPECT_NEAR(detail::area(coarse.mesh), 22.0, 1e-9);
  EXPECT_LT(detail::apart(coarse.mesh, fine), 1e-12);
}

TEST(Coarsen, TheRimOfARoundFaceStaysInItsPlane) {
  const SurfaceMesh fine = bar(160, 60);
  const detail::Subdivided coarse = detail::coarsened(fine, 0.5, 0.02);
  EXPECT_TRUE(inspect(coarse.mesh).clean());
  EXPECT_LT(coarse.mesh.triangles.size(), fine.triangles.size() / 15);
  EXPECT_NEAR(detail::six_volume(coarse.mesh) / detail::six_volume(fine), 1.0, 2e-3);
  double base = 0.0;
  for (const auto& t : coarse.mesh.triangles) {
    const Vector3d a = coarse.mesh.X.col(t[0]), b = coarse.mesh.X.col(t[1]),
                   c = coarse.mesh.X.col(t[2]);
    if (std::max({std::abs(a.z()), std::abs(b.z()), std::abs(c.z())}) < 1e-9)
      base += 0.5 * (b - a).cross(c - a).norm();
  }
  EXPECT_NEAR(base, std::numbers::pi, 0.03) << "the base is found as a plane, whole";
}

TEST(Coarsen, AMeshHasTheEdgeThatItIsToldAndSaysSo) {
  std::vector<std::string> said;
  FillOptions options;
  options.edge = 0.4;
  const TetMesh mesh = fill(ball(40), options, kPlace, &said);
  EXPECT_GT(quality(mesh).mean_edge, 0.25) << "0.05 of the file's own";
  EXPECT_NEAR(quality(mesh).volume, 4.0 / 3.0 * std::numbers::pi, 0.02);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0], HasSubstr("19200 triangles are finer than the mesh's edge of 0.4"));
  said.clear();
  fill(ball(6), options, kPlace, &said);
  EXPECT_THAT(said, testing::IsEmpty()) << "a surface as fine as the mesh stays as it is";
}

TEST(Coarsen, ThinWallsKeepTheirThickness) {
  SurfaceMesh sheet = test::box_surface({30, 20, 0.4}, 60);
  sheet.uv.clear();
  FillOptions options;
  options.edge = 2.0;
  const TetMesh mesh = fill(sheet, options, kPlace);
  EXPECT_NEAR(quality(mesh).volume, 240.0, 1e-8);
}

}  // namespace
}  // namespace hookeye
