// The least noise of a field by its own scatter: what is noise shows, what is mechanics does not.
#include "estimation/fit/field_scatter.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>

#include "estimation/field_block.h"

namespace hookeye::test {
namespace {

using Course = std::function<double(const Vector3d&)>;

/// A field of one component thrice, told by places, a course and noise.
struct Told {
  Matrix3Xd X;
  Course course;
  double noise = 0.0;
  int filter = 1;  ///< rows of points that a mean of noise is taken over
};

MeasuredSpec spec_of(const Told& told, unsigned seed = 1) {
  auto field = std::make_shared<FieldSpec>();
  field->X = told.X, field->components = 3, field->spacing = 1.0;
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  MeasuredSpec out;
  out.kind = MeasuredSpec::Kind::field;
  out.value.resize(3 * told.X.cols());
  VectorXd white(out.value.size() + 3 * told.filter);
  for (double& one : white) one = told.noise * normal(engine);
  for (Eigen::Index k = 0; k < told.X.cols(); ++k)
    for (int c = 0; c < 3; ++c) {
      double noise = 0.0;
      for (int f = 0; f < told.filter; ++f) noise += white[3 * (k + f) + c];
      out.value[3 * k + c] = told.course(told.X.col(k)) + noise / std::sqrt(double(told.filter));
    }
  out.sigma = VectorXd::Ones(out.value.size());
  out.field = std::move(field);
  return out;
}

Matrix3Xd grid(int n, const std::function<Vector3d(double, double)>& place) {
  Matrix3Xd out(3, n * n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) out.col(n * i + j) = place(i, j);
  return out;
}
Matrix3Xd flat(int n) {
  return grid(n, [](double i, double j) { return Vector3d(i, j, 0.0); });
}

double bending(const Vector3d& X) { return std::sin(0.12 * X.x()) * std::cos(0.09 * X.y()); }
/// Linear within elements of four steps, with the bends that a mesh makes of a bending.
double meshed(const Vector3d& X) {
  const double a = 4.0 * std::floor(X.x() / 4.0), share = (X.x() - a) / 4.0;
  return (1.0 - share) * std::sin(0.12 * a) + share * std::sin(0.12 * (a + 4.0));
}

double largest(const MeasuredSpec& spec) {
  const auto found = scatter_of_neighbours(spec);
  if (!found) return -1.0;
  return *std::max_element(found->sigma.begin(), found->sigma.end());
}

TEST(FieldScatter, WhiteNoiseShowsAboutAnySmoothCourse) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> anywhere(0.0, 24.0);
  Matrix3Xd scattered(3, 576);
  for (Eigen::Index k = 0; k < scattered.cols(); ++k)
    scattered.col(k) << anywhere(engine), 0.2 * anywhere(engine) + 3.0, 0.0;
  const Matrix3Xd tube = grid(
      24, [](double i, double j) { return Vector3d(9 * std::cos(i / 9), 9 * std::sin(i / 9), j); });
  for (const Matrix3Xd& X : {flat(24), tube, scattered})
    for (const Course& course : {Course(bending), Course(meshed)})
      for (const double noise : {0.01, 0.1}) {
        const auto found = scatter_of_neighbours(spec_of({X, course, noise}));
        ASSERT_TRUE(found);
        for (const double sigma : found->sigma)
          EXPECT_NEAR(sigma, noise, (noise > 0.05 ? 3.5 : 5.0) * found->error * noise);
        EXPECT_LT(found->error, 0.12);
      }
}

TEST(FieldScatter, MechanicsIsNoNoise) {
  EXPECT_LT(largest(spec_of({flat(24), bending})), 1e-4);
  // Of a mesh's bends, up to 0.03 from the course, less than a third.
  EXPECT_LT(largest(spec_of({flat(24), meshed})), 0.01);
  // Round the edges of a box the course has a bend everywhere.
  const Matrix3Xd box = grid(24, [](double i, double j) {
    const double around = std::fmod(i, 12.0), side = std::floor(i / 12.0);
    return side == 0.0 ? Vector3d(around, 0.0, j) : Vector3d(11.5, around + 0.5, j);
  });
  EXPECT_LT(largest(spec_of({box, [](const Vector3d& X) { return 0.3 * X.y() + 0.02 * X.x(); }})),
            0.02);
}

/// A filter takes noise out of sight: a bound all the same, never more than there is.
TEST(FieldScatter, WhatNeighboursShareShowsInPart) {
  for (const unsigned seed : {1u, 2u, 3u})
    for (const int filter : {2, 4, 8}) {
      const auto found = scatter_of_neighbours(spec_of({flat(24), bending, 0.1, filter}, seed));
      ASSERT_TRUE(found);
      for (const double sigma : found->sigma) EXPECT_LT(sigma, 0.1 * (1.0 + 3.0 * found->error));
    }
}

TEST(FieldScatter, FewPointsTellNothing) {
  EXPECT_FALSE(scatter_of_neighbours(spec_of({flat(6), bending, 0.1})));
  const Matrix3Xd line = grid(8, [](double i, double j) { return Vector3d(8 * i + j, 0.0, 0.0); });
  const auto slowly = [](const Vector3d& X) { return 1e-4 * X.squaredNorm(); };
  const auto found = scatter_of_neighbours(spec_of({line, slowly, 0.1}));
  ASSERT_TRUE(found);  // a line has second order along it
  EXPECT_NEAR(found->sigma[0], 0.1, 3.5 * found->error * 0.1);
}

/// Fields with the noise that their capture tells, of all the kinds that tests have.
TEST(FieldScatter, RightCapturesAreNotAccused) {
  const FieldBlock blocks[] = {{},
                               {.alike = true},
                               {.keys = ", correlation: 0"},
                               {.sigma = 1e-3, .in_plane = true},
                               {.sigma = 1e-4},
                               {.from_pull = true},
                               {.sigma = 1e-3, .strain = "green"},
                               {.sigma = 2e-4, .strain = "hencky"}};
  for (const FieldBlock& block : blocks) {
    const auto scene = block.scene();
    int asked = 0;
    for (const ExampleSpec& example : scene->capture.examples)
      for (const MeasuredSpec& measured : example.measured) {
        const auto found = scatter_of_neighbours(measured);
        if (!found) continue;
        ++asked;
        const double most = scene->limits->floor.at * (1.0 + 3.0 * found->error);
        for (const double sigma : found->sigma)
          EXPECT_LT(sigma, most * block.sigma) << example.name << " " << block.strain << block.keys;
        if (!block.alike && example.name == "rest") {
          EXPECT_GT(found->sigma[0], 0.7 * block.sigma);
        }
      }
    EXPECT_EQ(asked, block.strain.empty() ? 8 : 0);  // strains jump at the truth's elements
  }
}

}  // namespace
}  // namespace hookeye::test
