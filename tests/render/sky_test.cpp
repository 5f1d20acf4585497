// How much sky the places of a body see.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "render/frame.h"
#include "render/ray_scene.h"

namespace hookeye::test {

namespace {

/// A bowl, rougher towards one side, of 2 (n - 1)^2 triangles.
struct Bowl {
  static constexpr int n = 17;
  Matrix3Xd x = Matrix3Xd(3, n*n), normals = Matrix3Xd::Zero(3, n*n);
  std::vector<std::array<int, 3>> triangles;

  Bowl() {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double u = 2.0 * i / (n - 1) - 1.0, v = 2.0 * j / (n - 1) - 1.0;
        x.col(n * i + j) = Vector3d(
            10.0 * u, 10.0 * v, 6.0 * (u * u + v * v) + (1.0 + u) * std::sin(7.0 * v + 3.0 * u));
      }
    for (int i = 0; i + 1 < n; ++i)
      for (int j = 0; j + 1 < n; ++j) {
        const int a = n * i + j;
        triangles.push_back({a, a + n, a + n + 1});
        triangles.push_back({a, a + n + 1, a + 1});
      }
    for (const auto& t : triangles) {
      const Vector3d a = x.col(t[0]), b = x.col(t[1]), c = x.col(t[2]);
      for (const int k : t) normals.col(k) += (b - a).cross(c - a);
    }
    normals.colwise().normalize();
  }
};

/// The rays of a place turn with the body: all but those that graze an edge end as they did.
TEST(Sky, IsSeenTheSameHoweverTheBodyStands) {
  constexpr int kRays = 64;
  const Bowl bowl;
  const std::vector<double> first =
      sky_visibility(RayScene(bowl.triangles, bowl.x), bowl.x, bowl.normals, kRays);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Vector3d(0.4, -0.7, 0.2).normalized()).toRotationMatrix();
  const Matrix3Xd x = (1e-3 * R * bowl.x).colwise() + Vector3d(0.3, -0.1, 0.2);
  const std::vector<double> turned =
      sky_visibility(RayScene(bowl.triangles, x), x, R * bowl.normals, kRays);
  double hidden = 0.0, off = 0.0;
  for (size_t i = 0; i < first.size(); ++i) {
    hidden += 1.0 - first[i];
    off += std::abs(turned[i] - first[i]);
  }
  EXPECT_GT(hidden, 0.05 * first.size()) << "there is nothing to see";
  EXPECT_LT(off, 1e-3 * hidden);
}

}  // namespace

}  // namespace hookeye::test
