// How many numbers of a field count, where what is left of it hangs together over the surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "capture_io/capture.h"

namespace hookeye {
namespace {

using Eigen::VectorXd;

constexpr int kAlong = 60, kAcross = 24, kPiece = 3;

/// Points of a plane, two components each, in pieces of nine.
FieldSpec plane() {
  FieldSpec out;
  out.components = 2;
  out.X.resize(3, kAlong * kAcross);
  out.piece.resize(static_cast<size_t>(out.X.cols()));
  out.alike = VectorXd::Ones(out.X.cols());
  out.pieces = kAlong / kPiece * (kAcross / kPiece);
  out.piece_at.resize(3, out.pieces);
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const int k = i * kAcross + j, piece = i / kPiece * (kAcross / kPiece) + j / kPiece;
      out.X.col(k) << i, j, 0.0;
      out.piece[static_cast<size_t>(k)] = piece;
      out.piece_at.col(piece) << i / kPiece, j / kPiece, 0;
    }
  return out;
}

VectorXd white(const FieldSpec& field, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  VectorXd out(field.components * field.X.cols());
  for (double& x : out) x = normal(engine);
  return out;
}

/// Sums over `width` x `width` points, round about, over `width`: of unit variance again.
VectorXd smoothed(const FieldSpec& field, const VectorXd& r, int width) {
  VectorXd out = VectorXd::Zero(r.size());
  for (Eigen::Index k = 0; k < field.X.cols(); ++k)
    for (int i = 0; i < width; ++i)
      for (int j = 0; j < width; ++j) {
        const Eigen::Index other =
            (k / kAcross + i) % kAlong * kAcross + (k % kAcross + j) % kAcross;
        out.segment(2 * k, 2) += r.segment(2 * other, 2) / width;
      }
  return out;
}

TEST(FieldStatistics, OfWhiteNoiseEveryNumberCounts) {
  const FieldSpec field = plane();
  double sum = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed)
    sum += field.effective(white(field, seed)) / field.numbers() / 20.0;
  EXPECT_GT(sum, 0.93);
  EXPECT_LE(sum, 1.0);
}

/// The mean square of numbers that hang together scatters as that of `effective` free ones does.
TEST(FieldStatistics, TheMeanSquareScattersAsThatOfTheNumbersThatCount) {
  const FieldSpec field = plane();
  constexpr int kDraws = 300;
  for (const int width : {2, 4, 8}) {
    double squares = 0.0, mean = 0.0, effective = 0.0;
    for (unsigned seed = 1; seed <= kDraws; ++seed) {
      const VectorXd r = smoothed(field, white(field, seed), width);
      const double v = r.squaredNorm() / field.numbers();
      effective += field.effective(r) / kDraws;
      mean += v / kDraws;
      squares += v * v / kDraws;
    }
    const double scattered = 2.0 * mean * mean / (squares - mean * mean);
    // Within a factor of 1.5: correlations that change within a piece count by their mean.
    EXPECT_GT(effective, scattered / 1.5) << width;
    EXPECT_LT(effective, scattered * 1.5) << width;
  }
}

/// A bend over the whole specimen is a handful of numbers, and no order of points changes that.
TEST(FieldStatistics, ABendIsAHandfulOfNumbers) {
  FieldSpec field = plane();
  VectorXd r(2 * field.X.cols());
  for (Eigen::Index k = 0; k < field.X.cols(); ++k)
    r.segment(2 * k, 2).setConstant(50.0 *
                                    std::cos(2.0 * std::numbers::pi * field.X(0, k) / kAlong));
  r += white(field, 3);
  const double effective = field.effective(r);
  EXPECT_GE(effective, 1.0);
  EXPECT_LT(effective, 10.0);

  std::vector<int> order(static_cast<size_t>(field.X.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  FieldSpec other = field;
  VectorXd there(r.size());
  for (size_t k = 0; k < order.size(); ++k) {
    other.piece[k] = field.piece[static_cast<size_t>(order[k])];
    there.segment(2 * static_cast<Eigen::Index>(k), 2) = r.segment(2 * order[k], 2);
  }
  EXPECT_NEAR(other.effective(there), effective, 1e-9 * effective);
  EXPECT_NEAR(field.effective(1e3 * r), effective, 1e-9 * effective);
}

}  // namespace
}  // namespace hookeye
