// A scan, whole or in part, gives the body's place from any side.
#include "placing/scan.h"

#include <gmock/gmock.h>

#include "placing/placed_capture.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::string joined(const std::vector<std::string>& all) {
  std::string text;
  for (const std::string& one : all) text += one + "\n";
  return text;
}

/// The body's surface where it truly lies in the cameras' frame, cut finer, `noise` on each vertex.
SurfaceMesh scan_of(const PlacedCapture& placed, double noise, std::mt19937& random) {
  SurfaceMesh out;
  const SurfaceMesh& surface = placed.scene().body->surface.mesh;
  out.X = (PlacedCapture::true_place() * surface.X.colwise().homogeneous()).eval();
  out.triangles = surface.triangles;
  for (int round = 0; round < 2; ++round) {  // each triangle into four
    SurfaceMesh finer;
    std::vector<Vector3d> X;
    for (const auto& t : out.triangles) {
      const int first = static_cast<int>(X.size());
      const Vector3d a = out.X.col(t[0]), b = out.X.col(t[1]), c = out.X.col(t[2]);
      for (const Vector3d& x :
           {a, b, c, Vector3d(0.5 * (a + b)), Vector3d(0.5 * (b + c)), Vector3d(0.5 * (c + a))})
        X.push_back(x);
      for (const auto& k : {std::array{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
        finer.triangles.push_back({first + k[0], first + k[1], first + k[2]});
    }
    finer.X = Eigen::Map<const Matrix3Xd>(X.front().data(), 3, Eigen::Index(X.size()));
    out = std::move(finer);
  }
  std::normal_distribution<double> normal(0.0, noise);
  if (noise > 0)
    for (Eigen::Index i = 0; i < out.X.size(); ++i) out.X.data()[i] += normal(random);
  return out;
}

void keep(SurfaceMesh* scan, const std::function<bool(const Vector3d&)>& wanted) {
  std::erase_if(scan->triangles,
                [&](const auto& t) { return !wanted(Vector3d(scan->X.col(t[0]))); });
}

TEST(Scan, WholeOnesGiveThePlaceFromAnySide) {
  std::mt19937 random(2);
  const Vector3d middle = middle_of(Shape::bracket);
  for (const double degrees : {20.0, 100.0, 180.0}) {
    const PlacedCapture placed({}, random_motion(middle, degrees, 100, random));
    const ScanFit found =
        place_by_scan(scan_of(placed, 0.0, random), {"scan.ply"}, placed.told(), placed.body(), {});
    EXPECT_LT(placed.off(found.placing.motion), 1e-3) << degrees;
    EXPECT_GT(found.used, 0.99);
    EXPECT_GT(found.covered, 0.85);
    EXPECT_THAT(found.placing.warnings, IsEmpty()) << joined(found.placing.warnings);
  }
}

TEST(Scan, PartsWithNoiseAndAStandAreTrimmed) {
  std::mt19937 random(3);
  const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), 40, 30, random));
  SurfaceMesh scan = scan_of(placed, 0.05, random);
  // What one scanner sees from ahead and above, and a plate beside the body.
  const Vector3d from(0.4, -0.7, 0.6);
  std::erase_if(scan.triangles, [&](const auto& t) {
    const Vector3d a = scan.X.col(t[0]), b = scan.X.col(t[1]), c = scan.X.col(t[2]);
    return (b - a).cross(c - a).normalized().dot(from.normalized()) < 0.1;
  });
  const auto n = static_cast<int>(scan.X.cols());
  scan.X.conservativeResize(3, n + 4);
  scan.X.rightCols(4) << 30, 60, 60, 30, -40, -40, 0, 0, -30, -30, -30, -30;
  scan.triangles.push_back({n, n + 1, n + 2});
  scan.triangles.push_back({n, n + 2, n + 3});
  const ScanFit found = place_by_scan(scan, {"scan.ply"}, placed.told(), placed.body(), {});
  EXPECT_LT(placed.off(found.placing.motion), 0.1);
  EXPECT_LT(found.used, 0.9);
  EXPECT_GT(found.used, 0.3);
}

TEST(Scan, UnitsShow) {
  std::mt19937 random(3);
  const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), 40, 30, random));
  SurfaceMesh scan = scan_of(placed, 0.0, random);
  scan.X *= 1e-3;
  const ScanFit found =
      place_by_scan(scan, {"scan.ply"}, placed.told(), placed.body(), {.scale = 1000.0});
  EXPECT_LT(placed.off(found.placing.motion), 1e-3);
  try {
    place_by_scan(scan, {"scan.ply"}, placed.told(), placed.body(), {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scan.ply: the scan is 0.05"));
    EXPECT_THAT(error.what(), HasSubstr("--scan-unit"));
  }
}

TEST(Scan, SymmetricBodiesAreToldAsAmbiguous) {
  std::mt19937 random(4);
  PlacedSetup setup;
  setup.shape = Shape::brick;
  const PlacedCapture brick(setup, random_motion(middle_of(Shape::brick), 30, 6, random));
  const ScanFit found =
      place_by_scan(scan_of(brick, 0.02, random), {"scan.ply"}, brick.told(), brick.body(), {});
  EXPECT_LT(brick.off(found.placing.motion), 0.1);
  EXPECT_EQ(found.placing.others.size(), 3u);
  setup.shape = Shape::cone;
  const PlacedCapture cone(setup, random_motion(middle_of(Shape::cone), 10, 6, random));
  // One side alone of a body of revolution: nothing tells turns about its axis.
  const ScanFit round =
      place_by_scan(scan_of(cone, 0.02, random), {"scan.ply"}, cone.told(), cone.body(), {});
  EXPECT_FALSE(round.placing.warnings.empty());
}

TEST(Scan, AFlatPieceSlides) {
  std::mt19937 random(4);
  PlacedSetup setup;
  setup.shape = Shape::brick;
  const PlacedCapture brick(setup, random_motion(middle_of(Shape::brick), 10, 6, random));
  SurfaceMesh scan = scan_of(brick, 0.01, random);
  const Isometry3d back = PlacedCapture::true_place().inverse();
  keep(&scan, [&](const Vector3d& x) {
    const Vector3d X = back * x;
    return X.z() > 13.8 && std::abs(X.x() - 20) < 12 && std::abs(X.y() - 12) < 8;
  });
  const ScanFit found = place_by_scan(scan, {"scan.ply"}, brick.told(), brick.body(), {});
  EXPECT_THAT(joined(found.placing.warnings), HasSubstr("a shift along"));
}

}  // namespace
}  // namespace hookeye::test
