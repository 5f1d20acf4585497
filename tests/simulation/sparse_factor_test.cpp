// One factor whatever else is factored at the same time.
#include "simulation/sparse_factor.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <numeric>
#include <thread>
#include <vector>

#include "simulation/blocks.h"

namespace hookeye {
namespace {

/// Springs between all nodes of an element, each node tied to the ground a little.
SparseMatrix springs(const TetMesh& mesh) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int a, int b, double value) {
    for (int c = 0; c < 3; ++c) entries.emplace_back(3 * a + c, 3 * b + c, value);
  };
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e)
    for (int i = 0; i < mesh.elements.rows(); ++i)
      for (int k = 0; k < mesh.elements.rows(); ++k)
        add(mesh.elements(i, e), mesh.elements(k, e), i == k ? mesh.elements.rows() : -1.0);
  SparseMatrix K(3 * mesh.X.cols(), 3 * mesh.X.cols());
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

VectorXd solved(const SparseMatrix& K) {
  std::vector<int> free(K.cols() - 3);  // one node is held
  std::iota(free.begin(), free.end(), 3);
  TangentFactor factor(std::make_shared<SymbolicFactor>(K, free));
  EXPECT_TRUE(factor.factorize(K));
  VectorXd x;
  factor.solve(test::noise(K.cols() - 3, 2), x);
  return x;
}

/// Eigen's factor has other code, another order and indices of 32 bits.
TEST(SparseFactor, SolvesAsOneOfNarrowIndices) {
  const SparseMatrix K = springs(test::block(6, 5, 7, {1, 1, 1}, 2, 0.2));
  const Eigen::Index n = K.cols() - 3;
  const Eigen::SimplicialLDLT<SparseMatrix> narrow(SparseMatrix(K.bottomRightCorner(n, n)));
  ASSERT_EQ(narrow.info(), Eigen::Success);
  const VectorXd x = narrow.solve(test::noise(n, 2));
  EXPECT_LT((solved(K) - x).norm(), 1e-12 * x.norm());
}

TEST(SparseFactor, ShiftIsOnTheDiagonal) {
  const SparseMatrix K = springs(test::block(3, 4, 3, {1, 1, 1}, 1, 0.2));
  std::vector<int> free(K.cols() - 3);
  std::iota(free.begin(), free.end(), 3);
  TangentFactor factor(std::make_shared<SymbolicFactor>(K, free));
  ASSERT_TRUE(factor.factorize(K, 2.5));
  const VectorXd b = test::noise(K.cols() - 3, 3);
  VectorXd x;
  factor.solve(b, x);
  const VectorXd back = K.bottomRightCorner(b.size(), b.size()) * x + 2.5 * x;
  EXPECT_LT((back - b).norm(), 1e-12 * b.norm());
}

TEST(SparseFactor, IndefiniteIsSolvedToo) {
  SparseMatrix K = springs(test::block(3, 4, 3, {1, 1, 1}, 1, 0.2));
  K.diagonal().array() -= 30.0;  // nodes have 1 to 24 elements, 4 on the diagonal each
  std::vector<int> free(K.cols() - 3);
  std::iota(free.begin(), free.end(), 3);
  TangentFactor factor(std::make_shared<SymbolicFactor>(K, free));
  EXPECT_FALSE(factor.factorize(K));
  ASSERT_TRUE(factor.factorize_indefinite(K));
  const VectorXd b = test::noise(K.cols() - 3, 3);
  VectorXd x;
  factor.solve(b, x);
  EXPECT_LT((K.bottomRightCorner(b.size(), b.size()) * x - b).norm(), 1e-9 * b.norm());
}

/// The orders had come out of one sequence of random numbers that all threads drew from.
TEST(SparseFactor, IsTheSameBesideOthers) {
  const SparseMatrix K[2] = {springs(test::block(9, 9, 9, {1, 1, 1}, 1, 0.2)),
                             springs(test::block(14, 8, 5, {1, 1, 1}, 1, 0.2))};
  const VectorXd alone[2] = {solved(K[0]), solved(K[1])};
  for (int round = 0; round < 8; ++round) {
    std::vector<VectorXd> x(4);
    std::vector<std::thread> threads;
    for (size_t i = 0; i < x.size(); ++i) threads.emplace_back([&, i] { x[i] = solved(K[i % 2]); });
    for (std::thread& thread : threads) thread.join();
    for (size_t i = 0; i < x.size(); ++i) EXPECT_EQ(x[i], alone[i % 2]) << i << ", " << round;
  }
}

}  // namespace
}  // namespace hookeye
