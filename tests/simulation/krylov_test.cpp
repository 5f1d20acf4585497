// Krylov solves with an unsymmetric tangent against dense elimination.
#include "simulation/krylov.h"

#include <Eigen/LU>

#include "simulation/bent_block.h"

namespace hookeye {
namespace {

/// H: the stiffness of a held block; W: a skew matrix on some of its free unknowns, `size` times
/// as stiff.
struct System {
  TetMesh mesh = test::block(2, 1, 1, {2, 1, 1}, 2);
  std::vector<int> free;
  SparseMatrix K, W{0, 0}, W_ff{0, 0};
  std::shared_ptr<TangentFactor> H;
  MatrixXd dense;  ///< of K_ff = H + W_ff

  explicit System(double size) {
    Loading loading;
    test::hold(mesh, test::plane(mesh, 0, 0), loading);
    K = tangent(mesh, test::of(neo_hookean(0.05, 0.6)), loading, mesh.X.reshaped());
    std::vector<int> index(K.cols(), -1);
    for (int u = 0; u < K.cols(); ++u)
      if (!std::binary_search(loading.prescribed.begin(), loading.prescribed.end(), u)) {
        index[u] = static_cast<int>(free.size());
        free.push_back(u);
      }
    H = std::make_shared<TangentFactor>(std::make_shared<SymbolicFactor>(K, free));
    EXPECT_TRUE(H->factorize(K));
    Triplets all, inside;
    const VectorXd values = size * K.diagonal().mean() * test::noise(K.cols(), 4);
    for (int u : test::plane(mesh, 0, 2).nodes)
      for (SparseMatrix::InnerIterator it(K, 3 * u); it; ++it) {
        const int i = static_cast<int>(it.row()), j = 3 * u;
        for (const auto& [a, b, sign] : {std::tuple(i, j, 1.0), {j, i, -1.0}}) {
          all.emplace_back(a, b, sign * values[i]);
          if (index[a] >= 0 && index[b] >= 0)
            inside.emplace_back(index[a], index[b], sign * values[i]);
        }
      }
    W.resize(K.rows(), K.cols());
    W.setFromTriplets(all.begin(), all.end());
    const auto n = static_cast<Eigen::Index>(free.size());
    W_ff.resize(n, n);
    W_ff.setFromTriplets(inside.begin(), inside.end());
    dense = MatrixXd(K)(free, free) + MatrixXd(W_ff);
  }
};

TEST(Krylov, SkewGradientsSolveHoweverLargeTheSkewPart) {
  for (const double size : {0.01, 1.0, 30.0}) {
    const System s(size);
    ASSERT_GT(s.W_ff.norm(), 0.0);
    MatrixXd B = test::noise(s.W_ff.rows() * 4, 8).reshaped(s.W_ff.rows(), 4);
    B.col(1).setZero();
    B.col(3) *= 1e-9;  // done on its own scale
    MatrixXd X;
    const int iterations = skew_gradients(s.W_ff, *s.H, B, 1e-11, 500, X);
    EXPECT_GT(iterations, 1) << size;
    const MatrixXd exact = s.dense.partialPivLu().solve(B);
    for (const int j : {0, 2, 3})
      EXPECT_LE((X.col(j) - exact.col(j)).norm(), 1e-9 * exact.col(j).norm()) << size;
    EXPECT_EQ(X.col(1).norm(), 0.0);
    EXPECT_EQ(skew_gradients(s.W_ff, *s.H, B, 1e-11, 1, X), -1);
  }
}

TEST(Krylov, GmresSolvesOnTheFactorOfAnotherMatrixPositiveOrNot) {
  for (const bool positive : {true, false}) {
    System s(0.3);
    SparseMatrix other = s.K;  // further from K_ff than a load step, or of another signature
    other.diagonal() *= 1.3;
    if (!positive) other.coeffRef(s.free[5], s.free[5]) *= -1.0;
    ASSERT_EQ(s.H->factorize(other), positive);
    ASSERT_TRUE(positive || s.H->factorize_indefinite(other));
    const VectorXd b = test::noise(s.W_ff.rows(), 8);
    VectorXd x;
    EXPECT_GT(gmres(s.K + s.W, *s.H, b, 1e-11, 300, x), 1);
    const VectorXd exact = s.dense.partialPivLu().solve(b);
    EXPECT_LE((x - exact).norm(), 1e-9 * exact.norm());
    EXPECT_EQ(gmres(s.K + s.W, *s.H, b, 1e-11, 2, x), -1);
  }
}

}  // namespace
}  // namespace hookeye
