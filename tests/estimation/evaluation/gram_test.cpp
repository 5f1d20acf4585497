// Sums over columns of any units: what is known of one does not depend on the units of another.
#include "estimation/evaluation/gram.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Columns {
  MatrixXd H;   ///< of columns of one unit
  VectorXd of;  ///< units, twenty powers of ten apart
  MatrixXd mixed() const { return of.asDiagonal() * H * of.asDiagonal(); }
};

Columns some_columns() {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  MatrixXd J(60, 5);
  for (double& x : J.reshaped()) x = normal(engine);
  return {J.transpose() * J, (VectorXd(5) << 1e10, 1.0, 1e-3, 1e5, 1e-10).finished()};
}

TEST(Gram, ASquareRootKeepsTheColumnsOfEveryUnit) {
  const Columns columns = some_columns();
  const MatrixXd A = square_root(columns.mixed(), lengths(columns.mixed()), columns.of);
  const VectorXd back = columns.of.cwiseInverse();
  EXPECT_LT((back.asDiagonal() * A * A.transpose() * back.asDiagonal() - columns.H).norm(),
            1e-10 * columns.H.norm());
}

/// Columns turned among those of one scale, and in another order.
TEST(Gram, ASquareRootTurnsWithItsColumns) {
  const Columns columns = some_columns();
  const VectorXd scale = (VectorXd(5) << 3.0, 3.0, 3.0, 7.0, 0.5).finished();
  const VectorXd towards = (VectorXd(5) << 1.0, -2.0, 0.3, 0.7, 5.0).finished();
  MatrixXd turn = MatrixXd::Identity(5, 5);
  turn.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  turn.row(3).swap(turn.row(4));
  const MatrixXd first = square_root(columns.H, scale, towards);
  const VectorXd scale_turned = (VectorXd(5) << 3.0, 3.0, 3.0, 0.5, 7.0).finished();
  const MatrixXd turned =
      square_root(turn * columns.H * turn.transpose(), scale_turned, turn * towards);
  EXPECT_LT((turned - turn * first).norm(), 1e-9 * first.norm());
}

/// A camera that looks along z sees x and y; what it knows of z is little, and must not be noise of
/// the others.
TEST(Gram, ASquareRootKeepsAColumnFarShorterThanItsScale) {
  const Columns columns = some_columns();
  const VectorXd shrink = (VectorXd(5) << 1.0, 1.0, 1e-9, 1.0, 1.0).finished();
  const MatrixXd H = shrink.asDiagonal() * columns.H * shrink.asDiagonal();
  VectorXd scale = lengths(columns.H);
  scale.head(3).setConstant(scale.head(3).norm());
  const MatrixXd A = square_root(H, scale, VectorXd::Ones(5));
  const VectorXd back = shrink.cwiseInverse();
  EXPECT_LT((back.asDiagonal() * A * A.transpose() * back.asDiagonal() - columns.H).norm(),
            1e-10 * columns.H.norm());
}

TEST(Gram, APseudoInverseInvertsTheColumnsOfEveryUnit) {
  const Columns columns = some_columns();
  const MatrixXd one = pseudo_inverse(columns.H), mixed = pseudo_inverse(columns.mixed());
  EXPECT_LT((one * columns.H - MatrixXd::Identity(5, 5)).norm(), 1e-10);
  EXPECT_LT((columns.of.asDiagonal() * mixed * columns.of.asDiagonal() - one).norm(),
            1e-10 * one.norm());
}

TEST(Gram, ColumnsThatSayNothingStayOut) {
  MatrixXd H = MatrixXd::Zero(3, 3);
  H(0, 0) = 4.0;
  EXPECT_EQ(pseudo_inverse(H).row(1).norm() + pseudo_inverse(H).col(2).norm(), 0.0);
  EXPECT_DOUBLE_EQ(pseudo_inverse(H)(0, 0), 0.25);
  EXPECT_EQ(square_root(H, lengths(H), VectorXd::Ones(3)).row(2).norm(), 0.0);
  EXPECT_EQ(pseudo_inverse(MatrixXd(0, 0)).size(), 0);
}

/// Eigenvectors are zero at such a column to rounding alone, which was scaled by 150 powers of ten.
TEST(Gram, ColumnsThatSayNothingStayOutBesideManyThatDo) {
  std::mt19937 engine(4);
  std::normal_distribution<double> normal;
  MatrixXd J(60, 16);
  for (double& x : J.reshaped()) x = normal(engine);
  for (Eigen::Index silent = 0; silent < J.cols(); ++silent) {
    MatrixXd some = J;
    some.col(silent).setZero();
    const MatrixXd H = some.transpose() * some, inverse = pseudo_inverse(H);
    EXPECT_EQ(inverse.row(silent).norm() + inverse.col(silent).norm(), 0.0) << silent;
    EXPECT_LT((H * inverse * H - H).norm(), 1e-10 * H.norm()) << silent;
    EXPECT_EQ(square_root(H, lengths(H), VectorXd::Ones(16)).row(silent).norm(), 0.0) << silent;
  }
}

}  // namespace
}  // namespace hookeye
