// Directions and planes that turn with the body.
#include "estimation/effects/own_directions.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "estimation/effects/floor_planes.h"
#include "estimation/effects/toolbox.h"
#include "estimation/effects_scene.h"
#include "meshing/extent.h"

namespace hookeye::test {

namespace {

using Eigen::Matrix3d;

const Matrix3d& some_turn() {
  static const Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vector3d(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
  return turn;
}

/// By how much the lines of `a` and those of `b` are not the same ones.
double lines_apart(const Matrix3d& a, const Matrix3d& b) {
  return (1.0 - (a.transpose() * b).cwiseAbs().colwise().maxCoeff().array()).maxCoeff();
}

TetMesh stretched(const TetMesh& told, const Vector3d& by) {
  TetMesh out = told;
  out.X = by.asDiagonal() * told.X;
  return out;
}

TetMesh turned(const TetMesh& told) {
  TetMesh out = told;
  out.X = (some_turn() * told.X).colwise() + Vector3d(300.0, -20.0, 7.0);
  return out;
}

TEST(OwnAxes, OfABlockAreItsEdges) {
  const TetMesh& block = block_scene()->body->mesh;  // 20 x 16 x 40
  EXPECT_LT((own_axes(block) - Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_LT(lines_apart(own_axes(turned(block)), some_turn()), 1e-9);
}

/// Its moments say nothing; its faces do.
TEST(OwnAxes, OfASquareBlockAndOfACubeAreTheirEdges) {
  const TetMesh& block = block_scene()->body->mesh;
  for (const Vector3d& by : {Vector3d(1.0, 1.25, 1.0), Vector3d(1.0, 1.25, 0.5)}) {
    const TetMesh square = stretched(block, by);
    EXPECT_LT(lines_apart(own_axes(square), Matrix3d::Identity()), 1e-9);
    EXPECT_LT(lines_apart(own_axes(turned(square)), some_turn()), 1e-9);
  }
}

TEST(OwnAxes, OfAnyBodyTurnWithIt) {
  TetMesh odd = block_scene()->body->mesh;
  for (Eigen::Index a = 0; a < odd.X.cols(); ++a) {
    const Vector3d x = odd.X.col(a);
    odd.X.col(a) += Vector3d(0.3 * x.z(), 0.02 * x.x() * x.z(), 0.01 * x.y() * x.y());
  }
  EXPECT_GT(lines_apart(own_axes(odd), Matrix3d::Identity()), 1e-3);
  EXPECT_LT(lines_apart(own_axes(turned(odd)), some_turn() * own_axes(odd)), 1e-9);
}

TEST(SpreadLines, AreTheSameInAnyOrderAndCoverAll) {
  const auto lines = spread_lines();
  ASSERT_EQ(lines.size(), 25u);
  for (size_t i = 0; i < kAxes; ++i)
    EXPECT_EQ(lines[i], Vector3d(Vector3d::Unit(static_cast<Eigen::Index>(i))));
  const auto nearest = [&](const Vector3d& d) -> double {
    double most = 0.0;
    for (const Vector3d& line : lines) most = std::max(most, std::abs(line.dot(d)));
    return std::acos(std::min(1.0, most)) * 180.0 / EIGEN_PI;
  };
  for (const Vector3d& line : lines) {
    EXPECT_LT(nearest(Vector3d(line.y(), line.x(), -line.z())), 1e-5);
    EXPECT_LT(nearest(Vector3d(line.z(), -line.y(), line.x())), 1e-5);
  }
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  double farthest = 0.0;
  for (int i = 0; i < 20000; ++i)
    farthest = std::max(
        farthest, nearest(Vector3d(normal(engine), normal(engine), normal(engine)).normalized()));
  EXPECT_LT(farthest, 19.2);
  EXPECT_GT(farthest, 15.0);
}

TEST(SpreadLines, AreWrittenAsTheyAre) {
  const TetMesh& block = block_scene()->body->mesh;
  for (const TetMesh& mesh : {block, turned(block)})
    for (const Vector3d& line : own_lines(mesh)) {
      const auto read = numbers_in(direction_text(line));
      EXPECT_EQ(Vector3d(read.at(0), read.at(1), read.at(2)), line);
      EXPECT_NEAR(line.norm(), 1.0, 2e-5);
    }
  EXPECT_EQ(direction_text({0.314, -0.209, 0.926}), "(0.314, -0.209, 0.926)") << "of older runs";
}

TEST(Extent, OfABlockIsItsDiagonalHoweverItStands) {
  const Eigen::Matrix3Xd& X = block_scene()->body->mesh.X;
  EXPECT_NEAR(extent(X), Vector3d(20.0, 16.0, 40.0).norm(), 1e-9);
  EXPECT_NEAR(extent((some_turn() * X).colwise() + Vector3d(300.0, 0.0, 0.0)), extent(X), 1e-9);
  EXPECT_EQ(extent(Eigen::Matrix3Xd(3, 0)), 0.0);
  EXPECT_EQ(extent(X.leftCols(1)), 0.0);
}

/// Written to digits of the body's size: a plane 0.2 mm from a body that stands 300 mm from the
/// origin is as near to it as one of a body at the origin.
TEST(FloorPlanes, StandAsNearWhereverTheOriginIs) {
  for (const double origin : {0.0, 300.0, -3e4})
    for (const Vector3d& out : {Vector3d(1.0, 0.0, 0.0), Vector3d(0.851, 0.0, -0.525)}) {
      const ScoredPlane plane = plane_at(out, origin + 0.21237, 47.0);
      EXPECT_NEAR(plane.position - origin, 0.21237, 1e-4) << plane.text;
      const auto read = scored_plane(plane.text);
      ASSERT_TRUE(read) << plane.text;
      EXPECT_EQ(read->text, plane.text);
      EXPECT_EQ(read->position, plane.position);
      EXPECT_EQ(read->out, plane.out);
    }
}

/// What is written is read, and written again, as it was.
TEST(OwnDirections, AreToldAlikeOnceReadBack) {
  EXPECT_EQ(direction_text({1e-17, 1.0, -1e-12}), "(0.000, 1.000, 0.000)");
  EXPECT_EQ(direction_text({0.31415, 0.0, 0.94937}), "(0.31415, 0.00000, 0.94937)");
  EXPECT_EQ(direction_text({0.314, 0.0, 0.949}), "(0.314, 0.000, 0.949)");
}

}  // namespace

}  // namespace hookeye::test
