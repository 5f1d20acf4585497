// Surfaces as they come damaged, mended: each bounds the body that it was, and every step is told.
#include "meshing/repair.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "meshing/detail.h"
#include "shapes.h"
#include "support/needs_helper.h"

namespace hookeye {
namespace {

using namespace ::testing;
using test::box_surface;
using test::refusal;

const Place kPlace{"part.stl"};

class Repaired : public Test {
 protected:
  void SetUp() override { HOOKEYE_NEEDS_HELPER("repair", "libcgal-dev"); }

  /// 60 x 40 x 20, each side of 4 x 4 squares.
  static SurfaceMesh box() { return test::box_surface({60, 40, 20}, 4); }
  static constexpr double kVolume = 60.0 * 40.0 * 20.0;

  /// Each triangle with corners of its own, as an STL has them, moved by so much at random.
  static SurfaceMesh torn(const SurfaceMesh& s, double by) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> some(-by, by);
    SurfaceMesh out;
    out.X.resize(3, static_cast<Eigen::Index>(3 * s.triangles.size()));
    for (const auto& t : s.triangles) {
      const int first = static_cast<int>(3 * out.triangles.size());
      out.triangles.push_back({first, first + 1, first + 2});
      for (int k = 0; k < 3; ++k)
        out.X.col(first + k) =
            s.X.col(t[static_cast<size_t>(k)]) + Vector3d(some(random), some(random), some(random));
    }
    return out;
  }

  static void expect_body(const SurfaceMesh& s, double volume, double within = 1e-9) {
    EXPECT_TRUE(inspect(s).clean()) << inspect(s).describe(s);
    EXPECT_NEAR(detail::six_volume(s) / 6.0, volume, within * volume);
  }
};

TEST_F(Repaired, WhatIsWholeStaysAsItIs) {
  const SurfaceMesh whole = box();
  const RepairedSurface r = repair(whole, {}, kPlace);
  EXPECT_THAT(r.said, IsEmpty());
  EXPECT_EQ(r.surface.X, whole.X);
  EXPECT_EQ(r.surface.triangles, whole.triangles);
  EXPECT_EQ(r.moved, 0.0);
  EXPECT_NEAR(r.volume_before, kVolume, 1e-9 * kVolume);
  EXPECT_NEAR(r.volume, kVolume, 1e-9 * kVolume);
}

/// What has a hole enclosed nothing before; what is there twice did.
TEST_F(Repaired, TheVolumeIsToldBeforeAndAfter) {
  SurfaceMesh open = box();
  open.triangles.pop_back();
  const RepairedSurface filled = repair(open, {}, kPlace);
  EXPECT_TRUE(std::isnan(filled.volume_before));
  EXPECT_NEAR(filled.volume, kVolume, 1e-9 * kVolume);
  SurfaceMesh twice = box();
  twice.triangles.push_back(twice.triangles.front());
  EXPECT_NEAR(repair(twice, {}, kPlace).volume_before, kVolume, 1e-9 * kVolume);
}

TEST_F(Repaired, HolesAreFilledAndTheLongestIsPlaced) {
  SurfaceMesh s = box();
  s.triangles.erase(s.triangles.begin() + 3);  // one at the bottom
  s.triangles.erase(s.triangles.begin() + 40,  // a square of the top and more
                    s.triangles.begin() + 44);
  const RepairedSurface r = repair(s, {}, kPlace);
  expect_body(r.surface, kVolume);
  EXPECT_EQ(r.surface.triangles.size(), box().triangles.size());
  ASSERT_EQ(r.said.size(), 1u);
  EXPECT_THAT(r.said[0], AllOf(HasSubstr("filled 2 holes, the longest "), HasSubstr(" 20)")));
}

TEST_F(Repaired, AWholeSideMissingIsClosed) {
  SurfaceMesh s = box();
  s.triangles.erase(s.triangles.begin(), s.triangles.begin() + 32);  // the bottom
  const RepairedSurface r = repair(s, {}, kPlace);
  expect_body(r.surface, kVolume);
  EXPECT_THAT(r.said, ElementsAre(HasSubstr("filled 1 holes, the longest 200 around, at (")));
}

TEST_F(Repaired, FlippedFacetsAreTurned) {
  SurfaceMesh s = box();
  for (const size_t t : {5u, 6u, 70u}) std::swap(s.triangles[t][0], s.triangles[t][1]);
  const RepairedSurface r = repair(s, {}, kPlace);
  expect_body(r.surface, kVolume);
  EXPECT_THAT(r.said, ElementsAre("turned 3 triangles that faced against their neighbours"));
}

TEST_F(Repaired, CornersOfAnStlThatDoNotMeetAreMerged) {
  const SurfaceMesh s = torn(box(), 1e-4);
  EXPECT_FALSE(inspect(s).open_edges.empty());
  const RepairedSurface r = repair(s, {}, kPlace);
  expect_body(r.surface, kVolume, 1e-4);
  EXPECT_EQ(r.surface.X.cols(), box().X.cols());
  EXPECT_GT(r.moved, 1e-6);
  EXPECT_LT(r.moved, 4e-4);
  EXPECT_THAT(r.said, Contains(HasSubstr(fmt::format("merged {} corners over gaps of up to 0.000",
                                                     s.X.cols() - box().X.cols()))));
}

TEST_F(Repaired, AWiderGapWantsAToldTolerance) {
  const SurfaceMesh s = torn(box(), 0.05);
  EXPECT_THAT(refusal([&] { repair(s, {}, kPlace); }),
              AllOf(HasSubstr("part.stl: could not be mended"), HasSubstr("--tolerance")));
  expect_body(repair(s, {.tolerance = 0.3}, kPlace).surface, kVolume, 0.02);
}

TEST_F(Repaired, ACornerOnAnotherEdgeIsJoined) {
  // One triangle of the top cut in two, its neighbour across the cut edge not.
  SurfaceMesh s = box();
  const auto [a, b, c] = s.triangles[40];
  const auto mid = s.X.cols();
  s.X.conservativeResize(3, mid + 1);
  s.X.col(mid) = 0.5 * (s.X.col(a) + s.X.col(b));
  s.triangles[40] = {a, static_cast<int>(mid), c};
  s.triangles.push_back({static_cast<int>(mid), b, c});
  s.uv.clear();
  EXPECT_EQ(inspect(s).open_edges.size(), 3u);
  const RepairedSurface r = repair(s, {}, kPlace);
  expect_body(r.surface, kVolume);
  EXPECT_THAT(r.said, ElementsAre("cut 1 triangles where a corner of another lay on their open "
                                  "edge"));
}

TEST_F(Repaired, WhatIsThereTwiceGoes) {
  SurfaceMesh s = box();
  s.uv.clear();
  s.triangles.push_back(s.triangles[7]);
  s.triangles.push_back({s.triangles[9][1], s.triangles[9][2], s.triangles[9][0]});
  s.triangles.push_back({3, 3, 4});
  const RepairedSurface r = repair(s, {}, kPlace);
  expect_body(r.surface, kVolume);
  EXPECT_EQ(r.surface.triangles, box().triangles);
  EXPECT_THAT(r.said, ElementsAre("dropped 3 triangles that were there twice or had a corner "
                                  "twice"));
}

TEST_F(Repaired, TwoBoxesThatShareAWallBecomeOne) {
  SurfaceMesh s = box_surface({2, 1, 1}, 1), other = box_surface({1, 1, 1}, 1);
  other.X.row(0).array() += 2.0;
  SurfaceMesh both = torn(s, 0.0);
  const SurfaceMesh second = torn(other, 0.0);
  const auto before = both.X.cols();
  both.X.conservativeResize(3, before + second.X.cols());
  both.X.rightCols(second.X.cols()) = second.X;
  for (const auto& [a, b, c] : second.triangles) {
    const int n = static_cast<int>(before);
    both.triangles.push_back({n + a, n + b, n + c});
  }
  const RepairedSurface r = repair(both, {}, kPlace);
  expect_body(r.surface, 3.0);
  EXPECT_THAT(r.said, Contains("dropped 2 walls that were there from both sides"));
}

TEST_F(Repaired, AFlakeBesideTheBodyGoes) {
  SurfaceMesh s = box();
  s.uv.clear();
  const auto n = s.X.cols();
  s.X.conservativeResize(3, n + 4);
  s.X.rightCols(4) << 70, 80, 80, 75, 0, 0, 9, 2, 5, 5, 5, 9;
  const int first = static_cast<int>(n);
  s.triangles.push_back({first, first + 1, first + 2});                      // alone
  s.triangles.push_back({s.triangles[0][0], s.triangles[0][1], first + 3});  // on an edge
  const RepairedSurface r = repair(s, {}, kPlace);
  expect_body(r.surface, kVolume);
  EXPECT_EQ(r.surface.triangles, box().triangles);
  EXPECT_THAT(r.said, Contains("dropped 1 triangles that hung on an edge of two others"));
}

TEST_F(Repaired, ADentThatCrossesTheSurfaceIsCutOut) {
  SurfaceMesh s = box();
  // The middle of the top, pushed through the bottom.
  for (auto x : s.X.colwise())
    if (x.isApprox(Vector3d(30, 20, 20))) x.z() = -2.0;
  EXPECT_FALSE(inspect(s).self_intersections.empty());
  const RepairedSurface r = repair(s, {}, kPlace);
  EXPECT_TRUE(inspect(r.surface).clean());
  EXPECT_THAT(r.said,
              Contains(AllOf(HasSubstr("cut out "), HasSubstr("intersected, the first at ("))));
}

TEST_F(Repaired, BodiesThatOverlapAreRefusedWithThePlace) {
  SurfaceMesh s = box(), other = box();
  s.uv.clear();
  other.X.colwise() += Vector3d(31, 7, 3);
  const int n = static_cast<int>(s.X.cols());
  s.X.conservativeResize(3, 2 * n);
  s.X.rightCols(n) = other.X;
  for (const auto& [a, b, c] : other.triangles) s.triangles.push_back({n + a, n + b, n + c});
  EXPECT_THAT(refusal([&] { repair(s, {}, kPlace); }),
              AllOf(HasSubstr("two closed parts overlap near ("), HasSubstr("does not join")));
}

TEST_F(Repaired, RemeshedEdgesComeOutAsAskedAndSharpOnesStay) {
  const double edge = 4.0;
  const RepairedSurface r = repair(box(), {.edge = edge}, kPlace);
  expect_body(r.surface, kVolume);
  double sum = 0.0;
  for (const auto& t : r.surface.triangles)
    for (size_t k = 0; k < 3; ++k)
      sum += (r.surface.X.col(t[k]) - r.surface.X.col(t[(k + 1) % 3])).norm();
  EXPECT_NEAR(sum / (3.0 * static_cast<double>(r.surface.triangles.size())), edge, 0.2 * edge);
  EXPECT_LT(r.moved, 1e-9);
  EXPECT_THAT(r.said, ElementsAre(HasSubstr("remeshed to an edge of 4: ")));
}

TEST_F(Repaired, WhatARemeshTookFromAHoleIsTold) {
  // A bore of radius 4 through a plate: of its 24 corners as many are left as the edge lets.
  const SurfaceMesh plate = test::bored_plate(20.0, 4.0, 10.0, 3);
  const double volume = detail::six_volume(plate) / 6.0;
  const RepairedSurface r = repair(plate, {.edge = 6.0}, kPlace);
  EXPECT_GT(detail::six_volume(r.surface) / 6.0, 1.005 * volume) << "nothing was cut across";
  EXPECT_GT(r.moved, 0.3);  // 4 (1 - cos(pi / n)) of n corners
  EXPECT_LT(r.moved, 4.0);
}

TEST_F(Repaired, NothingIsNotABody) {
  EXPECT_THAT(refusal([&] { repair({}, {}, kPlace); }), HasSubstr("no triangles"));
  SurfaceMesh flake;
  flake.X = Matrix3Xd::Identity(3, 3);
  flake.triangles = {{0, 1, 2}};
  EXPECT_THAT(refusal([&] { repair(flake, {}, kPlace); }),
              HasSubstr("only 0 % of the surface's area encloses a volume"));
}

}  // namespace
}  // namespace hookeye
