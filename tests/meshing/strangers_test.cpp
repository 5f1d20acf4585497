// Surfaces as other programs write them: large plane faces cut into several triangles, turned and
// moved, in any unit, rounded to single precision or six digits.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <numbers>
#include <random>

#include "meshing/detail.h"
#include "shapes.h"

namespace hookeye {
namespace {

using test::extruded;
using test::refusal;
using Polygon = std::vector<Vector2d>;

Polygon circle(double radius, int corners) {
  Polygon p;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    p.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return p;
}

/// The upper polygon of a prism drawn together to a point.
SurfaceMesh cone(double radius, double height, int corners) {
  SurfaceMesh s = extruded(circle(radius, corners), test::fan(corners), height);
  const int apex = corners;
  for (auto& t : s.triangles)
    for (int& i : t) i = std::min(i, apex);
  std::erase_if(s.triangles,
                [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  s.X = s.X.leftCols(corners + 1).eval();
  s.X.col(apex) = Vector3d(0, 0, height);
  return s;
}

SurfaceMesh bracket() {
  const Polygon corners{{0, 0}, {60, 0}, {60, 10}, {10, 10}, {10, 45}, {0, 45}};
  return extruded(corners, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 25);
}

struct Stranger {
  std::string name;
  SurfaceMesh surface;
};

/// Parts of some 50 mm.
std::vector<Stranger> strangers() {
  std::vector<Stranger> all;
  all.push_back({"box", extruded({{0, 0}, {60, 0}, {60, 40}, {0, 40}}, test::fan(4), 20)});
  all.push_back({"bracket", bracket()});
  for (const int corners : {5, 16, 48}) {
    all.push_back({fmt::format("cone of {}", corners), cone(25, 60, corners)});
    all.push_back({fmt::format("cylinder of {}", corners),
                   extruded(circle(15, corners), test::fan(corners), 50)});
  }
  all.push_back({"thin plate", extruded({{0, 0}, {80, 0}, {80, 50}, {0, 50}}, test::fan(4), 0.8)});
  return all;
}

/// Random, the same every time.
Eigen::Quaterniond turned(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized();
}

SurfaceMesh placed(SurfaceMesh s, int seed, double away, double unit) {
  const Vector3d shift = away * (turned(-1 - seed) * Vector3d::UnitX());
  s.X = unit * ((turned(seed).toRotationMatrix() * s.X).colwise() + shift);
  return s;
}

SurfaceMesh rounded(SurfaceMesh s, const std::string& to) {
  for (double& x : s.X.reshaped()) {
    if (to == "single") x = static_cast<double>(static_cast<float>(x));
    if (to == "six digits") x = std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr);
  }
  return s;
}

TEST(Strangers, TurnedAndMovedPartsAreMeshedInEveryUnitAndRounding) {
  const Place place{"part.stl"};
  int seed = 0;
  for (const Stranger& stranger : strangers()) {
    const double volume = detail::six_volume(stranger.surface) / 6.0;
    for (const std::string to : {"nothing", "single", "six digits"}) {
      for (const double unit : {1.0, 1e-3, 1e3}) {
        SCOPED_TRACE(fmt::format("{}, rounded to {}, unit {} mm", stranger.name, to, 1 / unit));
        const SurfaceMesh s = rounded(placed(stranger.surface, seed++, 300.0, unit), to);
        FillOptions options;
        options.order = 1;
        options.edge = unit * 12;
        TetMesh mesh;
        ASSERT_NO_THROW(mesh = fill(mend(s, place).surface, options, place));
        const MeshQuality q = quality(mesh);
        EXPECT_NEAR(q.volume / std::pow(unit, 3), volume, 2e-3 * volume);
        // Sharp corners stay to the last bit.
        if (stranger.name == "box" || stranger.name == "bracket") {
          EXPECT_EQ(mesh.X.leftCols(s.X.cols()), s.X);
        }
        EXPECT_GT(q.min_radius_ratio, 1e-3);  // 0.006 and more; 1e-9 with the file's slivers
      }
    }
  }
}

TEST(Strangers, ACavityIsFoundFarFromTheOriginAndInEveryUnit) {
  int seed = 100;
  for (const double unit : {1.0, 1e-3, 1e3}) {
    for (int repeat = 0; repeat < 12; ++repeat) {
      SurfaceMesh s = extruded({{0, 0}, {60, 0}, {60, 40}, {0, 40}}, test::fan(4), 20);
      SurfaceMesh inner = extruded({{10, 10}, {30, 10}, {30, 30}, {10, 30}}, test::fan(4), 10);
      inner.X.row(2).array() += 5;
      const int before = static_cast<int>(s.X.cols());
      Matrix3Xd X(3, s.X.cols() + inner.X.cols());
      X << s.X, inner.X;
      s.X = X;
      for (const auto& t : inner.triangles)
        s.triangles.push_back({t[0] + before, t[2] + before, t[1] + before});
      s = placed(s, seed++, 3e4, unit);
      FillOptions options;
      options.order = 1;
      options.edge = unit * 12;
      EXPECT_NEAR(quality(fill(s, options, {"part.obj"})).volume / std::pow(unit, 3),
                  60 * 40 * 20 - 20 * 20 * 10, 1e-6);
    }
  }
}

TEST(Strangers, WhatIntersectsIsRefusedWherever) {
  int seed = 200;
  for (const double unit : {1.0, 1e-3, 1e3}) {
    SurfaceMesh s = bracket();
    s.X.col(3) = Vector3d(10, -1, 0);  // the inner corner out through the lower side
    s = placed(s, seed++, 300, unit);
    EXPECT_FALSE(inspect(s).self_intersections.empty());
    EXPECT_THAT(refusal([&] { mend(s, {"part.obj"}); }), ::testing::HasSubstr("intersect near ("));
  }
}

}  // namespace
}  // namespace hookeye
