// K in blocks of nodes, and on the linear tetrahedra below quadratic ones.
#include "simulation/petsc/node_blocks.h"

#include <gtest/gtest.h>

#include "core/memory_left.h"
#include "simulation/bent_block.h"
#include "simulation/petsc/parts.h"

namespace hookeye {
namespace {

using Eigen::MatrixXd;

/// At rest; some unknowns are held, alone and by threes.
struct Block {
  TetMesh mesh = test::block(4, 3, 3, {4, 3, 2}, 2, 0.3);
  SparseMatrix K = tangent(mesh, test::of(neo_hookean(0.05, 0.3)), {}, mesh.X.reshaped());
  std::vector<int> free;
  Block() {
    for (int u = 0; u < K.cols(); ++u)
      if (mesh.X(0, u / 3) > 1e-9 && u % 7 != 3) free.push_back(u);
  }
  bool is_free(int u) const { return std::binary_search(free.begin(), free.end(), u); }
};

template <int M>
void expect_product() {
  const Block b;
  NodeBlocks blocks(b.K, b.free);
  blocks.take(b.K, 0.25);
  Vectors<M> x(M, b.K.cols()), y;
  for (int m = 0; m < M; ++m) x.row(m) = test::noise(b.K.cols(), 5 + m).transpose();
  blocks.multiply<double, M>(blocks.values(), x, y);
  for (int m = 0; m < M; ++m) {
    VectorXd inside = x.row(m).transpose();
    for (int u = 0; u < inside.size(); ++u)
      if (!b.is_free(u)) inside[u] = 0.0;
    const VectorXd Kx = b.K * inside + 0.25 * inside;
    for (int u = 0; u < inside.size(); ++u)
      ASSERT_NEAR(y(m, u), b.is_free(u) ? Kx[u] : blocks.held_diagonal() * x(m, u), 1e-12) << u;
  }
}

TEST(NodeBlocks, MultiplyAsTheWholeOfK) {
  expect_product<1>();
  expect_product<4>();
}

/// Linear functions are quadratic ones, too: at rest, where D is the same everywhere, both have the
/// same K.
TEST(CornerBlocks, AreTheTangentOfLinearTetrahedra) {
  const Block b;
  NodeBlocks blocks(b.K, b.free);
  blocks.take(b.K, 0.0);
  const Eigen::Matrix2Xi ends = ends_of(b.mesh);
  CornerBlocks corners(b.K, blocks, ends);
  corners.take(b.K, 0.0, blocks);
  const TetMesh linear = with_order(b.mesh, 1);
  ASSERT_EQ(corners.corners(), linear.nodes());
  EXPECT_FALSE(corners.all());
  const SparseMatrix L = tangent(linear, test::of(neo_hookean(0.05, 0.3)), {}, linear.X.reshaped());
  // Nodes of the linear mesh by place; midside nodes that are held take their part away.
  NodeBlocks all(b.K, [&] {
    std::vector<int> u(b.K.cols());
    for (size_t i = 0; i < u.size(); ++i) u[i] = static_cast<int>(i);
    return u;
  }());
  all.take(b.K, 0.0);
  CornerBlocks free(b.K, all, ends);
  free.take(b.K, 0.0, all);
  for (int i = 0; i < free.corners(); ++i) {
    Eigen::Index row = -1;
    const double apart =
        (linear.X.colwise() - b.mesh.X.col(free.node(i))).colwise().norm().minCoeff(&row);
    ASSERT_LT(apart, 1e-12);
    ASSERT_EQ(row, i) << "both in the order of the mesh";
  }
  double largest = 0.0;
  for (int r = 0; r < L.rows(); ++r)
    for (int k = free.start()[r]; k < free.start()[r + 1]; ++k) {
      const double expected = L.coeff(r, free.column()[k]);
      largest = std::max(largest, std::abs(expected));
      ASSERT_NEAR(free.values()[k], expected, 1e-12);
    }
  EXPECT_GT(largest, 0.01);
  EXPECT_EQ(static_cast<Eigen::Index>(free.values().size()), L.nonZeros());
}

/// (P x) . y = x . (P^T y), and P takes nothing from held unknowns and gives them nothing.
TEST(CornerBlocks, ProlongAndRestrictAreTransposed) {
  const Block b;
  NodeBlocks blocks(b.K, b.free);
  blocks.take(b.K, 0.0);
  CornerBlocks corners(b.K, blocks, ends_of(b.mesh));
  const Vectors<1> x = test::noise(3 * corners.corners(), 2).transpose();
  const Vectors<1> y = test::noise(b.K.cols(), 3).transpose();
  Vectors<1> Px = Vectors<1>::Zero(1, b.K.cols());
  corners.add_prolonged<1>(blocks, x, Px);
  const double there = Px.dot(y);
  EXPECT_GT(std::abs(there), 0.1);
  EXPECT_NEAR(there, corners.restricted<1>(blocks, y).dot(x), 1e-12 * std::abs(there) + 1e-12);
  for (int u = 0; u < Px.size(); ++u)
    if (!b.is_free(u)) {
      EXPECT_EQ(Px[u], 0.0);
    }
}

TEST(Mumps, FactorsInMemoryAndOnDisk) {
  static const PetscSession session;
  const Block b;
  NodeBlocks blocks(b.K, b.free);
  blocks.take(b.K, 0.01);
  const MatrixXd B = test::noise(2 * b.K.cols(), 4).reshaped(b.K.cols(), 2);
  for (const bool on_disk : {false, true}) {
    if (on_disk) {
      set_memory_limit(2e9);
      set_memory_limit(2e9 - memory_left().bytes + 1e6);  // a million more than it has
    }
    const MumpsFactor factor(blocks);
    set_memory_limit(0.0);
    EXPECT_EQ(factor.on_disk(), on_disk);
    EXPECT_EQ(factor.negative(), 0);
    ASSERT_FALSE(factor.singular());
    MatrixXd X;
    factor.solve(B, X);
    for (int m = 0; m < 2; ++m) {
      Vectors<1> x = X.col(m).transpose(), Kx;
      blocks.multiply<double, 1>(blocks.values(), x, Kx);
      EXPECT_LT((Kx.transpose() - B.col(m)).norm(), 1e-10 * B.col(m).norm());
    }
  }
}

}  // namespace
}  // namespace hookeye
